# ROS 1: messages, nodelets, bag tools and launch tests.
