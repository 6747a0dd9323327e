// The nodelet manager of the launch files. It differs from `nodelet manager` in how it ends.
#include <cstdlib>

#include <nodelet/loader.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "manager");
  nodelet::Loader loader(ros::NodeHandle("~"));
  ros::spin();
  // When a launch ends, so do the processes that asked for the nodelets, and the loader's own thread unloads them. Its
  // destructor does not wait for that and destroys the same nodelets once more; this does wait.
  loader.clear();
  std::_Exit(EXIT_SUCCESS);  // that thread may still be at work in the loader, which holds nothing any more
}
