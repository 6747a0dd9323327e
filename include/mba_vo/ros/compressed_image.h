#pragma once

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

namespace mba_vo {

/// The image of a message as compressed_image_transport sends them (jpeg or png; `format` is "png", or as in
/// "bayer_rggb8; png compressed"), with the header of the message: what had been compressed, to the bit where png was
/// used. Throws std::invalid_argument naming the format if it cannot be decoded.
sensor_msgs::ImageConstPtr decodeImage(const sensor_msgs::CompressedImage& message);

}  // namespace mba_vo
