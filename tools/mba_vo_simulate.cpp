// Renders a camera that is carried through a procedural room, by an invented hand or as recorded, with motion blur and
// exact ground truth.
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include "mba_vo/io/progress_bar.h"
#include "mba_vo/simulation/folder_sink.h"
#include "mba_vo/simulation/frame_cache.h"
#include "mba_vo/simulation/simulator.h"
#ifdef MBA_VO_WITH_ROS
#include "mba_vo/ros/bag_sink.h"
#endif

namespace {

struct Arguments {
  mba_vo::SimulationConfig simulation;
  std::string output;
  std::string bag;
  std::string cache = mba_vo::FrameCache::defaultFolder();
  bool no_cache = false;
  bool overwrite = false;
  int threads = 0;
};

/// Makes an option of every value of the configuration.
class OptionMaker {
 public:
  explicit OptionMaker(CLI::App& app) : app_(app) {}

  template <typename T>
  void operator()(const char* name, T& value, double lowest, double highest, const char* help) {
    app_.add_option(optionName(name), value, help)
        ->capture_default_str()
        ->check(CLI::Range(static_cast<T>(lowest), static_cast<T>(highest)));
  }
  void operator()(const char* name, std::string& value, const char* help) {
    app_.add_option(optionName(name), value, help)->capture_default_str();
  }
  void operator()(const char* name, std::vector<double>& value, const char* help) {
    app_.add_option(optionName(name), value, help)->delimiter(',');
  }
  void operator()(const char* name, bool& value, const char* help) { app_.add_flag(optionName(name), value, help); }

 private:
  static std::string optionName(std::string name) {
    std::replace(name.begin(), name.end(), '_', '-');
    return "--" + name;
  }

  CLI::App& app_;
};

void describe(CLI::App& app, Arguments& a) {
  app.add_option("--output", a.output, "sequence folder to write, made if need be");
  app.add_option("--bag", a.bag, "bag to write (needs a build with ROS)");
  app.add_flag("--overwrite", a.overwrite, "replace a sequence that is already in the output folder");
  app.add_option("--cache", a.cache, "folder that keeps rendered images")->capture_default_str();
  app.add_flag("--no-cache", a.no_cache, "render everything afresh and keep nothing");
  app.add_option("--threads", a.threads, "threads that render, 0 = all cores")
      ->capture_default_str()
      ->check(CLI::Range(0, 1024));
  OptionMaker maker(app);
  mba_vo::SimulationConfig::describe(a.simulation, maker);
}

/// Hands every frame to several sinks.
class Outputs : public mba_vo::SequenceSink {
 public:
  void add(std::unique_ptr<mba_vo::SequenceSink> sink) { sinks_.push_back(std::move(sink)); }
  void write(const mba_vo::SimulatedFrame& frame) override {
    for (const auto& sink : sinks_) sink->write(frame);
  }
  void finish() override {
    for (const auto& sink : sinks_) sink->finish();
  }

 private:
  std::vector<std::unique_ptr<mba_vo::SequenceSink>> sinks_;
};

std::unique_ptr<mba_vo::SequenceSink> openBag(const std::string& file, const mba_vo::CameraCalibration& calibration) {
#ifdef MBA_VO_WITH_ROS
  return mba_vo::makeBagSink(file, calibration);
#else
  static_cast<void>(calibration);
  throw std::invalid_argument("--bag " + file + ": this program was built without ROS; use --output");
#endif
}

Outputs openOutputs(const Arguments& a, const mba_vo::CameraCalibration& calibration) {
  Outputs outputs;
  if (!a.output.empty()) outputs.add(std::make_unique<mba_vo::FolderSink>(a.output, calibration, a.overwrite));
  if (!a.bag.empty()) outputs.add(openBag(a.bag, calibration));
  return outputs;
}

void simulate(const Arguments& a) {
  if (a.output.empty() && a.bag.empty()) throw std::invalid_argument("--output or --bag is needed");
  if (a.simulation.hide_exposure && !a.bag.empty()) {
    throw std::invalid_argument(
        "--hide-exposure is for --output; in a bag the exposure is a topic that can be left out");
  }
  std::optional<tbb::global_control> threads;
  if (a.threads > 0) {
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(a.threads));
  }
  const mba_vo::Simulator simulator(a.simulation);
  Outputs outputs = openOutputs(a, a.simulation.toldCalibration());
  std::vector<double> blur;
  {
    mba_vo::ProgressBar bar(std::cerr, static_cast<std::size_t>(simulator.frames()), isatty(STDERR_FILENO) != 0);
    mba_vo::renderSequence(simulator, outputs, a.no_cache ? "" : a.cache, [&](int done) {
      bar.update(static_cast<std::size_t>(done));
      blur.push_back(simulator.groundTruth(done - 1).blur_px);
      return true;
    });
  }
  std::sort(blur.begin(), blur.end());
  std::cout << blur.size() << " frames written; blur at 2 m: median " << blur[blur.size() / 2] << " px, 90 % "
            << blur[blur.size() * 9 / 10] << " px, largest " << blur.back() << " px\n";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Simulates a camera in a furnished room, hand-held or on a recorded motion: blurred images with exact start and "
      "end poses.");
  Arguments arguments;
  describe(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    simulate(arguments);
  } catch (const std::exception& error) {
    std::cerr << "mba_vo_simulate: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
