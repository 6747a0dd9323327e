#include "mba_vo/tracking/reference.h"

namespace mba_vo {

const char* toString(ReferenceCause cause) {
  switch (cause) {
    case ReferenceCause::kMapBegins:
      return "map begins";
    case ReferenceCause::kKeyframe:
      return "keyframe";
    case ReferenceCause::kSharperImage:
      return "sharper image";
    case ReferenceCause::kFoundAgain:
      return "found again";
    case ReferenceCause::kSentAgain:
      return "sent again";
    case ReferenceCause::kMapClosed:
      return "map closed";
  }
  return "";
}

}  // namespace mba_vo
