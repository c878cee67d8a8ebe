"""Messages of packages that are not here, made of their definitions: publishers of them declare the original types."""
import genpy.dynamic

SEPARATOR = "=" * 80
HEADER = "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
POINT = "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n"


def generate(datatype, *parts):
    """Classes by type, of a definition and of those that it contains."""
    return genpy.dynamic.generate_dynamic(datatype, ("\n" + SEPARATOR + "\n").join(parts))


VICON = generate(
    "vicon_bridge/Markers",
    "Header header\nuint32 frame_number # Vicon Frame Number\nvicon_bridge/Marker[] markers # Array of Markers\n", HEADER,
    "MSG: vicon_bridge/Marker\nstring marker_name\nstring subject_name\nstring segment_name\n"
    "geometry_msgs/Point translation\nbool occluded\n", POINT)

MOCAP = generate(
    "mocap_base/MarkerList", "std_msgs/Header header\nmocap_base/Marker[] markers\n", HEADER,
    "MSG: mocap_base/Marker\nstring id\nbool labeled\nbool tracked\ngeometry_msgs/Point position\nfloat64 residual\n",
    POINT)

# Two packages of the same name.
PHASESPACE = generate(
    "phasespace_msgs/Markers", "phasespace_msgs/Marker[] markers\n",
    "MSG: phasespace_msgs/Marker\nuint32 id\nuint32 tracker_id\nstring name\nstring options\nuint32 flags\n"
    "geometry_msgs/Point position\nfloat32 condition\n", POINT)
PHASESPACE_SERVER = generate(
    "phasespace_msgs/Markers", "Header header\nphasespace_msgs/Marker[] markers\n", HEADER,
    "MSG: phasespace_msgs/Marker\nuint32 id\nuint32 flags\nuint64 time\nfloat32 x\nfloat32 y\nfloat32 z\nfloat32 cond\n")
