#pragma once

#include <string>

namespace mba_vo {

/// Options of TrajectoryDeblurrer.
struct TrajectoryDeblurConfig {
  double min_blur_px = 4.0;
  double prior_weight = 0.2;
  double max_residual = 1.6;
  double max_disagreement = 0.1;
  int steps = 5;
  int iterations = 8;
  int frames = 1;
  double max_misalignment_px = 1.0;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("min_blur_px", c.min_blur_px, 0.0, 100.0, "blur up to which a keyframe is left as it is [px]");
    v("prior_weight", c.prior_weight, 1e-4, 10.0, "weight of the total variation [1 / grey level]");
    v("max_residual", c.max_residual, 1.0, 100.0,
      "rms of the result blurred again minus the keyframe up to which it is trusted [noise]");
    v("max_disagreement", c.max_disagreement, 0.01, 10.0,
      "difference of two measurements of the motion up to which it is trusted, relative to the blur");
    v("steps", c.steps, 1, 20, "steps of the half-quadratic splitting");
    v("iterations", c.iterations, 1, 100, "iterations of conjugate gradients in a step");
    v("frames", c.frames, 1, 2, "2: a frame before or after that is blurred otherwise is used as well, if it fits");
    v("max_misalignment_px", c.max_misalignment_px, 0.01, 10.0,
      "median shift between that frame and what is expected of it up to which it is used [px]");
  }
};

/// Options of OnnxDeblurrer. The network is given (intensity - mean) scale.
struct OnnxDeblurConfig {
  std::string model;
  int channels = 3;
  double mean = 127.5;
  double scale = 1.0 / 127.5;
  double gamma = 2.2;
  bool residual = false;
  int multiple_of = 32;
  int width = 0;
  int height = 0;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("model", c.model, "network in ONNX form");
    v("channels", c.channels, 1, 3, "of its input and output: 1 or 3");
    v("gamma", c.gamma, 1.0, 4.0,
      "of the pictures that the network was trained on; it sees intensity^(1/gamma), 1 = linear light");
    v("mean", c.mean, -255.0, 255.0, "subtracted from what it sees [grey levels]");
    v("scale", c.scale, 1e-6, 1e3, "then multiplied by this [1 / grey level]");
    v("residual", c.residual, "the network gives what is to be added to its input");
    v("multiple_of", c.multiple_of, 1, 512, "sides of an image are filled up to a multiple of this [px]");
    v("width", c.width, 0, 8192, "of the only size that the network takes: images are cut into tiles [px], 0 = any");
    v("height", c.height, 0, 8192, "of the only size that the network takes [px], 0 = any");
  }
};

/// Options of FolderDeblurrer.
struct FolderDeblurConfig {
  std::string images;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("images", c.images,
      "folder with a rectified image, linear in light, per frame: NUMBER.png, webp or jpg, six digits");
  }
};

/// Options of all deblurrers. `describe` names every option once, for YAML, ROS parameters and documentation.
struct DeblurConfig {
  std::string method = "none";
  bool check = true;
  TrajectoryDeblurConfig trajectory;
  OnnxDeblurConfig onnx;
  FolderDeblurConfig folder;

  template <typename Config, typename Visitor>
  static void describe(Config& c, Visitor& v) {
    v("method", c.method,
      "how keyframes are deblurred: none, trajectory (along the path of each pixel), onnx (a network) or folder "
      "(images "
      "made beforehand)");
    v("check", c.check,
      "a sharp image is used in the map only if with it the keyframe explains the others of the window no worse");
    v.section("trajectory", c.trajectory);
    v.section("onnx", c.onnx);
    v.section("folder", c.folder);
  }
};

}  // namespace mba_vo
