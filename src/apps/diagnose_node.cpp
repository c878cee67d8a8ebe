// Keeps the last minutes of an arm's topics and diagnoses them when asked.
#include "diagnose_node/diagnose_node.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "softarm_diagnose");
  ros::NodeHandle nh, private_nh("~");
  try {
    softarm::app::DiagnoseNode node(nh, private_nh, softarm::app::DiagnoseNodeParams::read(private_nh));
    node.spin();
  } catch (const std::exception& e) {
    ROS_FATAL("%s", e.what());
    return 1;
  }
  return 0;
}
