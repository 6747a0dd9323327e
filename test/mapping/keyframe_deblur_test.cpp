#include <opencv2/imgcodecs.hpp>

#include "io/temporary_folder.h"
#include "mapping/mapper_fixture.h"

namespace mba_vo {
namespace {

/// Every keyframe is deblurred, that too with which the map begins: here by images in a folder, 9 grey levels brighter.
TEST(KeyframeDeblur, TheFirstReferenceIsDeblurredToo) {
  const TemporaryFolder folder;
  for (const FrameConstPtr& frame : test::frames()) {
    char name[32];
    std::snprintf(name, sizeof(name), "%06d.png", static_cast<int>(frame->sequence));
    cv::imwrite(folder.file(name), frame->pyramid.level(0).intensity + 9.0F);
  }
  MapperConfig config = test::config();
  config.deblur.method = "folder";
  config.deblur.folder.images = folder.file("");
  Mapper mapper(config);
  const ReferenceConstPtr reference = test::initialise(mapper).output.reference;
  ASSERT_TRUE(reference);
  const FrameConstPtr& frame = test::frames().at(static_cast<std::size_t>(reference->hint->frame_sequence));
  ASSERT_EQ(frame->mid_exposure_ns, reference->mid_exposure_ns);
  const float original = frame->pyramid.level(0).intensity(100, 120);
  ASSERT_LT(original, 240.0F);
  EXPECT_NEAR(reference->pyramid->level(0).intensity(100, 120), original + 9.0F, 0.51F);
  EXPECT_TRUE(reference->image_xi.isZero(0.0));
}

}  // namespace
}  // namespace mba_vo
