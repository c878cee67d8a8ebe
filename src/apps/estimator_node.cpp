// The live estimator of one soft arm.
#include "ros/estimator_node.h"

#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "softarm_estimator");
  ros::NodeHandle nh, private_nh("~");
  try {
    softarm::EstimatorNode node(nh, private_nh, softarm::NodeParams::read(private_nh));
    node.spin();
  } catch (const std::exception& e) {
    ROS_FATAL("%s", e.what());
    return 1;
  }
  return 0;
}
