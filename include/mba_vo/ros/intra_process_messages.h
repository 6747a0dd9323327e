#pragma once

#include <string>

#include <mba_vo/ReferenceSummary.h>
#include <mba_vo/TrackedFrameSummary.h>
#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <boost/shared_ptr.hpp>

#include "mba_vo/odometry/pipeline_messages.h"

namespace mba_vo {

/// What the tracker nodelet hands to the mapper nodelet. Within the process the message itself is shared; outside it
/// degrades to its summary (`message.tracked` is null), which is to be reported and not used.
struct TrackedFrameMessage {
  TrackedFrameSummary summary;
  TrackerMessage message;
};
using TrackedFrameMessageConstPtr = boost::shared_ptr<const TrackedFrameMessage>;

/// What the mapper nodelet hands to the tracker nodelet; outside the process only the summary (`reference` is null).
struct ReferenceMessage {
  ReferenceSummary summary;
  ReferenceConstPtr reference;
};
using ReferenceMessageConstPtr = boost::shared_ptr<const ReferenceMessage>;

/// `number` is left to the caller.
TrackedFrameSummary summarize(const TrackerMessage& message);
/// `header.stamp`, `session` and `status` are left to the caller.
ReferenceSummary summarize(const Reference& reference, const std::string& map_frame);

}  // namespace mba_vo

// On the wire both are their summaries.
namespace ros {
namespace message_traits {

#define MBA_VO_TRAITS_OF_SUMMARY(Message, Summary)                                               \
  template <>                                                                                    \
  struct IsMessage<Message> : TrueType {};                                                       \
  template <>                                                                                    \
  struct MD5Sum<Message> {                                                                       \
    static const char* value() { return MD5Sum<Summary>::value(); }                              \
    static const char* value(const Message& m) { return MD5Sum<Summary>::value(m.summary); }     \
  };                                                                                             \
  template <>                                                                                    \
  struct DataType<Message> {                                                                     \
    static const char* value() { return DataType<Summary>::value(); }                            \
    static const char* value(const Message& m) { return DataType<Summary>::value(m.summary); }   \
  };                                                                                             \
  template <>                                                                                    \
  struct Definition<Message> {                                                                   \
    static const char* value() { return Definition<Summary>::value(); }                          \
    static const char* value(const Message& m) { return Definition<Summary>::value(m.summary); } \
  };

MBA_VO_TRAITS_OF_SUMMARY(mba_vo::TrackedFrameMessage, mba_vo::TrackedFrameSummary)
MBA_VO_TRAITS_OF_SUMMARY(mba_vo::ReferenceMessage, mba_vo::ReferenceSummary)
#undef MBA_VO_TRAITS_OF_SUMMARY

}  // namespace message_traits

namespace serialization {

template <typename Message>
struct SummarySerializer {
  template <typename Stream>
  static void write(Stream& stream, const Message& message) {
    serialization::serialize(stream, message.summary);
  }
  template <typename Stream>
  static void read(Stream& stream, Message& message) {
    serialization::deserialize(stream, message.summary);
  }
  static std::uint32_t serializedLength(const Message& message) {
    return serialization::serializationLength(message.summary);
  }
};

template <>
struct Serializer<mba_vo::TrackedFrameMessage> : SummarySerializer<mba_vo::TrackedFrameMessage> {};
template <>
struct Serializer<mba_vo::ReferenceMessage> : SummarySerializer<mba_vo::ReferenceMessage> {};

}  // namespace serialization
}  // namespace ros
