#include "mba_vo/io/loops_csv.h"

#include <cmath>
#include <iomanip>

#include "mba_vo/io/trajectory_writer.h"

namespace mba_vo {

void writeLoops(const std::vector<LoopTrial>& loops, std::ostream& out) {
  out << "older_map,newer_map,older,newer,older_time,newer_time,correlation,tx,ty,tz,qx,qy,qz,qw,log_scale,sigma_x,"
         "sigma_y,sigma_z,"
         "sigma_rx,sigma_ry,sigma_rz,sigma_log_scale,pixel_error,disagreement_px,log_scale_by_depths,"
         "sigma_by_depths,log_scale_by_way,sigma_by_way,witnesses,weight,rejected_because\n";
  out << std::fixed << std::setprecision(6);
  for (const LoopTrial& loop : loops) {
    const LoopVerdict& v = loop.verdict;
    const Eigen::Vector3d& t = v.S_old_new.translation();
    const Eigen::Quaterniond& q = v.S_old_new.rotation();
    out << loop.older_map << "," << loop.newer_map << "," << loop.older << "," << loop.newer << ","
        << formatSeconds(loop.older_ns) << "," << formatSeconds(loop.newer_ns) << ","
        << loop.correlation.value_or(std::nan("")) << "," << t.x() << "," << t.y() << "," << t.z() << "," << q.x()
        << "," << q.y() << "," << q.z() << "," << q.w() << "," << std::log(v.S_old_new.scale());
    for (int i = 0; i < 7; ++i) out << "," << std::sqrt(v.covariance(i, i));
    out << "," << v.pixel_error << "," << v.disagreement_px << "," << v.by_depths.log_scale << "," << v.by_depths.sigma
        << "," << v.by_translations.log_scale << "," << v.by_translations.sigma << "," << v.witnesses << ","
        << loop.weight << ",\"" << v.rejected_because << "\"\n";
  }
}

}  // namespace mba_vo
