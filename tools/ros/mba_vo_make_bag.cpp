// Turns a folder of images into a bag that a live node can be fed with.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "mba_vo/datasets/dataset.h"
#include "mba_vo/ros/bag_image_writer.h"

int main(int argc, char** argv) {
  CLI::App app{"Turns a folder of images into a rosbag: /camera/image_raw, /camera/camera_info, /camera/exposure."};
  std::string sequence, output, images = "images", stamp_reference = "middle";
  app.add_option("SEQUENCE", sequence, "folder of a sequence or of a known data set")->required();
  app.add_option("--output", output, "bag to write")->required();
  app.add_option("--images", images, "subfolder of the images")->capture_default_str();
  app.add_option("--stamp-reference", stamp_reference, "what the stamps shall refer to: start, middle, end")
      ->capture_default_str();
  mba_vo::DepthFolder depth;
  app.add_option("--depth", depth.subfolder, "subfolder of depth images, if they are to be in the bag");
  app.add_option("--depth-units", depth.units_per_metre, "their units per metre")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  double time_offset = 0.0;
  app.add_option("--time-offset", time_offset, "added to all times [s]; a bag cannot hold the time 0")
      ->check(CLI::Range(-1e9, 1e9))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    mba_vo::DatasetOptions form;
    form.images = images;
    form.depth = depth;
    const auto reader = mba_vo::openDataset(sequence, form).reader;
    mba_vo::BagImageWriter writer(output, reader->calibration(), mba_vo::parseStampReference(stamp_reference));
    const std::int64_t offset_ns = std::llround(1e9 * time_offset);
    std::size_t count = 0;
    while (const auto image = reader->next()) {
      writer.write(image->mid_exposure_ns + offset_ns, image->exposure, image->image);
      if (!image->depth.empty()) writer.writeImage(mba_vo::BagImageWriter::kDepthTopic, image->depth);
      ++count;
    }
    writer.close();
    std::printf("%s: %zu images\n", output.c_str(), count);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mba_vo_make_bag: %s\n", error.what());
    std::remove(output.c_str());  // half a bag is worse than none
    return 1;
  }
  return 0;
}
