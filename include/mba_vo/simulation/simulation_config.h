#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mba_vo/geometry/pinhole_camera.h"
#include "mba_vo/image/frame_builder.h"

namespace mba_vo {

/// Everything that determines a simulated sequence. The same values always give the same images.
struct SimulationConfig {
  // Camera. The image is rendered through the distortion, as a real lens would show it.
  int width = 752;    // [px]
  int height = 480;   // [px]
  double fx = 430.0;  // [px]
  double fy = 0.0;    // [px]; 0 = fx
  double cx = -1.0;   // [px]; negative = middle of the image
  double cy = -1.0;   // [px]; negative = middle of the image
  std::string distortion_model = "plumb_bob";
  std::vector<double> distortion;

  // Timing.
  double rate = 27.0;          // [Hz]
  double exposure = 0.020;     // [s]
  double duration = 10.0;      // [s]
  double start_time = 1000.0;  // mid-exposure time of the first frame [s]
  double row_time = 0.0;       // rolling shutter: delay from row to row [s]; 0 = global shutter

  // Sensor.
  double noise = 1.0;     // standard deviation [grey levels]
  double gamma = 1.0;     // pixel = irradiance^(1/gamma); 1 = linear
  double vignette = 0.0;  // part of the light lost in the image corners
  double brightness = 1.0;

  // Scene and motion.
  int scene_seed = 1;
  int trajectory_seed = 1;
  double shake = 1.0;
  double path_length = 0.0;  // [m]; 0 = 0.4 m/s over the duration

  // Rendering.
  double max_step = 0.5;  // largest image motion between two sub-frames [px]

  // What a frame carries beside the blurred image.
  bool sharp = false;
  bool depth = false;

  /// Names every value with its range and meaning; the program's options, the checks and the cache key come from here.
  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("width", c.width, 16, 8192, "image width [px]");
    v("height", c.height, 16, 8192, "image height [px]");
    v("fx", c.fx, 1.0, 1e5, "focal length [px]");
    v("fy", c.fy, 0.0, 1e5, "vertical focal length [px], 0 = fx");
    v("cx", c.cx, -1.0, 8192.0, "principal point [px], -1 = middle of the image");
    v("cy", c.cy, -1.0, 8192.0, "principal point [px], -1 = middle of the image");
    v("distortion_model", c.distortion_model, "plumb_bob, rational_polynomial or equidistant");
    v("distortion", c.distortion, "distortion coefficients in the order of sensor_msgs/CameraInfo");
    v("rate", c.rate, 0.1, 1000.0, "frames per second [Hz]");
    v("exposure", c.exposure, 0.0, 1.0, "exposure time [s], at most one frame interval");
    v("duration", c.duration, 0.001, 3600.0, "length of the sequence [s]");
    v("start_time", c.start_time, 0.0, 4e9, "mid-exposure time of the first frame [s]");
    v("row_time", c.row_time, 0.0, 0.01, "rolling shutter: delay from row to row [s], 0 = global shutter");
    v("noise", c.noise, 0.0, 50.0, "standard deviation of the image noise [grey levels]");
    v("gamma", c.gamma, 0.1, 10.0, "gamma of the camera, 1 = linear");
    v("vignette", c.vignette, 0.0, 0.95, "part of the light lost in the image corners");
    v("brightness", c.brightness, 0.01, 10.0, "factor on the light of the scene");
    v("scene_seed", c.scene_seed, 0, 1000000000, "chooses the room, its furniture and textures");
    v("trajectory_seed", c.trajectory_seed, 0, 1000000000, "chooses the motion");
    v("shake", c.shake, 0.0, 4.0, "violence of the hand's shaking, 0 = smooth");
    v("path_length", c.path_length, 0.0, 1e4, "length of the camera's path [m], 0 = 0.4 m/s");
    v("max_step", c.max_step, 0.02, 4.0, "largest image motion between two sub-frames [px]");
    v("sharp", c.sharp, "also make the images without exposure");
    v("depth", c.depth, "also make depth images");
  }

  /// Throws std::invalid_argument naming the value and what is allowed.
  void validate() const;

  /// Changes the resolution and keeps the field of view.
  void resize(int new_width, int new_height);

  CameraCalibration calibration() const;
  PinholeCamera camera() const;  // without the distortion

  /// Text naming every value that determines the images (so not `sharp` and `depth`) and the renderer's version.
  std::string fingerprint() const;
};

}  // namespace mba_vo
