// The message definitions of sensor_msgs, std_msgs and geometry_msgs (ROS 1 Noetic) and of Livox's drivers, without
// their comments, which the MD5 sums leave out as well.
#include "pllit/io/ros_encoding.hpp"

namespace pllit {
namespace {

#define PLLIT_HEADER_DEFINITION                                                        \
  "================================================================================\n" \
  "MSG: std_msgs/Header\n"                                                             \
  "uint32 seq\n"                                                                       \
  "time stamp\n"                                                                       \
  "string frame_id\n"

constexpr std::string_view kImuDefinition =
    "Header header\n"
    "geometry_msgs/Quaternion orientation\n"
    "float64[9] orientation_covariance\n"
    "geometry_msgs/Vector3 angular_velocity\n"
    "float64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\n"
    "float64[9] linear_acceleration_covariance\n"  //
    PLLIT_HEADER_DEFINITION
    "================================================================================\n"
    "MSG: geometry_msgs/Quaternion\n"
    "float64 x\n"
    "float64 y\n"
    "float64 z\n"
    "float64 w\n"
    "================================================================================\n"
    "MSG: geometry_msgs/Vector3\n"
    "float64 x\n"
    "float64 y\n"
    "float64 z\n";

constexpr std::string_view kPointCloud2Definition =
    "Header header\n"
    "uint32 height\n"
    "uint32 width\n"
    "PointField[] fields\n"
    "bool is_bigendian\n"
    "uint32 point_step\n"
    "uint32 row_step\n"
    "uint8[] data\n"
    "bool is_dense\n"  //
    PLLIT_HEADER_DEFINITION
    "================================================================================\n"
    "MSG: sensor_msgs/PointField\n"
    "uint8 INT8=1\n"
    "uint8 UINT8=2\n"
    "uint8 INT16=3\n"
    "uint8 UINT16=4\n"
    "uint8 INT32=5\n"
    "uint8 UINT32=6\n"
    "uint8 FLOAT32=7\n"
    "uint8 FLOAT64=8\n"
    "string name\n"
    "uint32 offset\n"
    "uint8 datatype\n"
    "uint32 count\n";

constexpr std::string_view kImageDefinition =
    "Header header\n"
    "uint32 height\n"
    "uint32 width\n"
    "string encoding\n"
    "uint8 is_bigendian\n"
    "uint32 step\n"
    "uint8[] data\n"  //
    PLLIT_HEADER_DEFINITION;

constexpr std::string_view kCompressedImageDefinition =
    "Header header\n"
    "string format\n"
    "uint8[] data\n"  //
    PLLIT_HEADER_DEFINITION;

#define PLLIT_LIVOX_DEFINITION(package)                                                \
  "Header header\n"                                                                    \
  "uint64 timebase\n"                                                                  \
  "uint32 point_num\n"                                                                 \
  "uint8 lidar_id\n"                                                                   \
  "uint8[3] rsvd\n"                                                                    \
  "CustomPoint[] points\n" PLLIT_HEADER_DEFINITION                                     \
  "================================================================================\n" \
  "MSG: " package                                                                      \
  "/CustomPoint\n"                                                                     \
  "uint32 offset_time\n"                                                               \
  "float32 x\n"                                                                        \
  "float32 y\n"                                                                        \
  "float32 z\n"                                                                        \
  "uint8 reflectivity\n"                                                               \
  "uint8 tag\n"                                                                        \
  "uint8 line\n"

constexpr std::string_view kLivoxMd5 = "e4d6829bdfe657cb6c21a746c86b21a6";

}  // namespace

const RosType kImuType = {"sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2", kImuDefinition};
const RosType kPointCloud2Type = {"sensor_msgs/PointCloud2", "1158d486dd51d683ce2f1be655c3c181",
                                  kPointCloud2Definition};
const RosType kImageType = {"sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743", kImageDefinition};
const RosType kCompressedImageType = {"sensor_msgs/CompressedImage", "8f7a12909da2c9d3332d540a0977563f",
                                      kCompressedImageDefinition};
const RosType kLivoxCustomMsgType = {"livox_ros_driver/CustomMsg", kLivoxMd5,
                                     PLLIT_LIVOX_DEFINITION("livox_ros_driver")};
const RosType kLivoxCustomMsg2Type = {"livox_ros_driver2/CustomMsg", kLivoxMd5,
                                      PLLIT_LIVOX_DEFINITION("livox_ros_driver2")};

}  // namespace pllit

#undef PLLIT_HEADER_DEFINITION
#undef PLLIT_LIVOX_DEFINITION
