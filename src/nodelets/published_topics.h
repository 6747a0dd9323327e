#pragma once

#include "mba_vo/ros/topic_advice.h"

namespace mba_vo {

/// What is published at present, by the master; empty if that does not answer.
TopicTypes publishedTopics();

}  // namespace mba_vo
