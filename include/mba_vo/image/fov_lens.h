#pragma once

namespace mba_vo {

/// The field-of-view model of a lens (Devernay and Faugeras, 2001), which OpenCV lacks: the angle off the axis becomes
/// a distance in the image. Radii are in focal lengths, `omega` [rad] is its one coefficient; 0 = a pinhole.

/// Radius in the image of a ray whose tangent to the axis is `radius`.
double fovDistortedRadius(double radius, double omega);

/// The inverse, in closed form. Infinite where the image would show what is 90 degrees off the axis or more.
double fovUndistortedRadius(double distorted_radius, double omega);

}  // namespace mba_vo
