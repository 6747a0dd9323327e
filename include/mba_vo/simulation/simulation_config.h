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

  // A recorded motion in place of the invented one; the room is made around it.
  std::string motion;  // file, see readMotionFile; empty = none
  double start = 0.0;  // of the piece that is used [s after the first pose]

  // Exposure that varies.
  double exposure_min = 0.0;     // [s]
  double exposure_max = 0.0;     // [s]; 0 = always `exposure`
  double exposure_period = 8.0;  // [s]
  bool auto_gain = false;        // the gain makes up for the exposure
  double gain_error = 0.0;       // largest relative error of the automatic gain

  int jpeg = 0;  // quality of the compression; 0 = none

  // What the camera tells of itself. It changes no image.
  bool hide_exposure = false;
  double calibration_focal_error = 0.0;   // relative
  double calibration_centre_error = 0.0;  // [px]

  /// Names every value with its range and meaning; the program's options, the checks and the cache key come from here.
  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    describeScene(c, v);
    describeOutputs(c, v);
    describeRecording(c, v);
    describeTold(c, v);
  }

  /// Throws std::invalid_argument naming the value and what is allowed.
  void validate() const;

  /// Changes the resolution and keeps the field of view.
  void resize(int new_width, int new_height);

  CameraCalibration calibration() const;
  /// What the camera tells: `calibration` with the errors asked for.
  CameraCalibration toldCalibration() const;
  PinholeCamera camera() const;  // without the distortion

  /// The longest exposure of any image [s].
  double longestExposure() const { return exposure_max > 0.0 ? exposure_max : exposure; }
  /// The light of an image comes from at most so long before and after the middle of its exposure [s].
  double exposureMargin() const { return 0.5 * longestExposure() + 0.5 * row_time * (height - 1); }

  /// Text naming every value that determines the images (so neither what else is made nor what the camera tells) and
  /// the renderer's version. A recorded motion counts by its poses, whatever its file is called; then throws as
  /// MotionPiece does.
  std::string fingerprint() const;

 private:
  void checkMotion() const;
  void checkExposures() const;

  template <typename Config, typename Visitor>
  static void describeScene(Config& c, Visitor& v) {
    v("width", c.width, 16, 8192, "image width [px]");
    v("height", c.height, 16, 8192, "image height [px]");
    v("fx", c.fx, 1.0, 1e5, "focal length [px]");
    v("fy", c.fy, 0.0, 1e5, "vertical focal length [px], 0 = fx");
    v("cx", c.cx, -1.0, 8192.0, "principal point [px], -1 = middle of the image");
    v("cy", c.cy, -1.0, 8192.0, "principal point [px], -1 = middle of the image");
    v("distortion_model", c.distortion_model, "plumb_bob, rational_polynomial, equidistant or fov");
    v("distortion", c.distortion, "distortion coefficients in the order of sensor_msgs/CameraInfo");
    v("rate", c.rate, 0.1, 1000.0, "frames per second [Hz]");
    v("exposure", c.exposure, 0.0, 1.0, "exposure time [s], at most one frame interval");
    v("duration", c.duration, 0.0, 3600.0, "length of the sequence [s], 0 = to the end of the recorded motion");
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
  }

  template <typename Config, typename Visitor>
  static void describeOutputs(Config& c, Visitor& v) {
    v("sharp", c.sharp, "also make the images without exposure");
    v("depth", c.depth, "also make depth images");
  }

  template <typename Config, typename Visitor>
  static void describeRecording(Config& c, Visitor& v) {
    v("motion", c.motion, "file of a recorded motion, t tx ty tz qx qy qz qw; the room is made around it");
    v("start", c.start, 0.0, 1e6, "where the motion is entered [s after its first pose]");
    v("exposure_min", c.exposure_min, 0.0, 1.0, "shortest exposure time [s], with --exposure-max");
    v("exposure_max", c.exposure_max, 0.0, 1.0, "longest exposure time [s], 0 = always --exposure");
    v("exposure_period", c.exposure_period, 0.1, 1e4, "time in which the exposure goes up and down [s]");
    v("auto_gain", c.auto_gain, "the gain, and with it the noise, makes up for the exposure");
    v("gain_error", c.gain_error, 0.0, 2.0, "largest relative error of the automatic gain");
    v("jpeg", c.jpeg, 0, 100, "quality of JPEG compression, 0 = none");
  }

  template <typename Config, typename Visitor>
  static void describeTold(Config& c, Visitor& v) {
    v("hide_exposure", c.hide_exposure, "times.txt says 0, unknown, in place of the exposure");
    v("calibration_focal_error", c.calibration_focal_error, -0.5, 0.5, "relative error of the written focal lengths");
    v("calibration_centre_error", c.calibration_centre_error, -100.0, 100.0,
      "error of both coordinates of the written principal point [px]");
  }
};

}  // namespace mba_vo
