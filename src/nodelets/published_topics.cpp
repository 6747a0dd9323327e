#include "published_topics.h"

#include <ros/master.h>
#include <ros/this_node.h>

namespace mba_vo {

TopicTypes publishedTopics() {
  XmlRpc::XmlRpcValue request, response, topics;
  request[0] = ros::this_node::getName();
  request[1] = "";
  TopicTypes types;
  constexpr bool kWait = false;  // ros::master::getTopics would, for ever
  if (!ros::master::execute("getPublishedTopics", request, response, topics, kWait)) return types;
  for (int i = 0; i < topics.size(); ++i) types[std::string(topics[i][0])] = std::string(topics[i][1]);
  return types;
}

}  // namespace mba_vo
