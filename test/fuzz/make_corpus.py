#!/usr/bin/python3
"""Recordings of a few lines and a message of each type, for test/fuzz/corpus: called by make_corpus with that folder."""
import io
import itertools
import os
import struct
import sys

import genpy
import rosbag
from geometry_msgs.msg import (Point, Point32, PointStamped, Pose, PoseStamped, Quaternion, TransformStamped, Vector3)
from nav_msgs.msg import Odometry
from sensor_msgs.msg import ChannelFloat32, FluidPressure, JointState, PointCloud, PointCloud2, PointField
from softarm_estimator.msg import (MocapMarker, MocapMarkerList, PhasespaceMarker, PhasespaceMarkers, ViconMarker,
                                   ViconMarkers)
from std_msgs.msg import Float32MultiArray, Float64, Float64MultiArray, Header
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker

LAYOUTS = {
    "poses": ("""separator: comma
time: {column: 1, unit: ms, start_stamp_s: 1600000000}
mocap:
  unit: mm
  up: y
  ahead_s: 0.01
  bodies:
    - {name: base, position: [2, 3, 4], orientation: [5, 6, 7, 8], orientation_order: wxyz}
    - {name: tip, position: [9, 10, 11]}
pressures: {unit: kPa, reference: gauge, inputs: [{topic: /pressure/chamber_1, column: 12, zero: 0.5}]}
payload: [{from_s: 0, kg: 0}, {from_s: 0.01, kg: 0.2}]
""", "".join(f"{10 * i},0,1000,0,1,0,0,0,{i},800,{2 * i},{20 + i}\n" for i in range(4)), None),
    "header": ("""separator: semicolon
decimal: comma
header: true
units_row: true
time: {column: t, unit: s}
mocap: {unit: m, up: z, drop_repeated: true, bodies: [{name: tip, position: [x, y, z]}]}
tensions: {unit: N, inputs: [{topic: /tendon/1/tension, column: f}]}
""", "# a comment\nt;x;y;z;f\ns;m;m;m;N\n0,00;0;0;0,2;1,5\n0,01;0,01;;0,2;1e-3\n\n0,02;nan;0;0,2;2\n", None),
    "joined": ("""header: true
time: {column: ID, period_s: 0.01}
join: {id: ID, inputs_id: ID, header: true}
mocap: {unit: m, up: y, bodies: [{name: disc_1, position: [x1, y1, z1]}]}
angles: {unit: deg, inputs: [{topic: /servo/1/angle, column: phi1}, {topic: /servo/1/command, column: u1, from: inputs}]}
""", "ID,x1,y1,z1,phi1\n1,0,0.1,0,10\n2,0,0.1,0.01,11\n3,0,0.1,0.02,12\n", "ID,u1\n1,5\n2.0,6\n03,7\n"),
}


def pose(x=0.1):
    return Pose(Point(x, 0.0, 0.8), Quaternion(0.0, 0.0, 0.0, 1.0))


def cloud2():
    fields = [PointField(n, 4 * i, PointField.FLOAT32, 1) for i, n in enumerate("xyz")]
    points = struct.pack("<6f", 0.0, 0.0, 0.9, 0.01, 0.0, 0.8)
    return PointCloud2(HEADER, 1, 2, fields, False, 12, 24, points, True)


HEADER = Header(1, genpy.Time(1000, 5), "world")
ARM_WITH_INPUTS = 12  # see message_target.cpp


def messages():
    """(arm, topic, type's definition and a 0 where it is not built in, message)"""
    transform = TransformStamped(header=HEADER, child_frame_id="v/ring_1")
    transform.transform.translation = Vector3(0.0, 0.0, 0.9)
    transform.transform.rotation.w = 1.0
    odometry = Odometry(header=HEADER)
    odometry.pose.pose = pose()
    vicon = [ViconMarker(marker_name="7", translation=Point(0.0, 0.0, 900.0)),
             ViconMarker(marker_name="8", translation=Point(10.0, 0.0, 800.0), occluded=True)]
    markers = Marker(header=HEADER, type=Marker.SPHERE_LIST, points=[Point(0.0, 0.0, 0.9), Point(0.01, 0.0, 0.8)])
    yield 0, 1, "", PoseStamped(HEADER, pose())
    yield 1, 1, "", transform
    yield 2, 1, "", odometry
    yield 3, 0, "", PointStamped(HEADER, Point(0.0, 0.0, 0.9))
    yield 4, 0, "", TFMessage([transform, transform])
    yield 5, 0, "\0", ViconMarkers(header=HEADER, markers=vicon)
    yield 6, 0, "\0", MocapMarkerList(header=HEADER, markers=[MocapMarker(), MocapMarker()])
    yield 7, 0, "\0", PhasespaceMarkers(markers=[PhasespaceMarker(id=7), PhasespaceMarker(id=8)])
    yield 8, 0, PhasespaceMarkers._full_text.replace(" markers", " data") + "\0", PhasespaceMarkers(markers=[PhasespaceMarker(id=7)])
    yield 9, 0, "", PointCloud(HEADER, [Point32(0.0, 0.0, 0.9)], [ChannelFloat32("intensity", [1.0])])
    yield 10, 0, "", cloud2()
    yield 11, 0, "", markers
    inputs = [FluidPressure(HEADER, 120e3, 0.0), Float32MultiArray(data=[1.0, 2.0]),
              Float64MultiArray(data=[1.0, 2.0, 3.0, 4.0]), Float64(3.0)]
    for topic, message in enumerate(inputs, 2):
        yield ARM_WITH_INPUTS, topic, "", message
    for topic in 6, 7:  # of types that are not built in
        yield ARM_WITH_INPUTS, topic, JointState._full_text + "\0", JointState(HEADER, ["a"], [0.1], [], [2.0])
    yield ARM_WITH_INPUTS, 8, "", Float64(0.2)


def write_bags(folder):
    """The bag of the rig is compressed by lz4: here is its beginning by the others."""
    topics = ["/mocap/base/pose", "/mocap/ring_1/pose", "/pressure/chamber_1", "/payload"]
    for compression in rosbag.Compression.NONE, rosbag.Compression.BZ2:
        path = os.path.join(folder, f"{compression}.bag")
        with rosbag.Bag(os.path.join(folder, "rig.bag")) as rig, rosbag.Bag(path, "w", compression) as bag:
            for topic, message, stamp in itertools.islice(rig.read_messages(topics), 12):
                bag.write(topic, message, stamp)
        with open(path, "r+b") as file:
            data = file.read().replace(b"BZh9", b"BZh1")  # blocks of 100 kB instead of 900: less memory to take, again and again
            file.seek(0)
            file.write(data)


def main():
    folder = sys.argv[1]
    write_bags(os.path.join(folder, "bag"))
    for name, (layout, recording, inputs) in LAYOUTS.items():
        parts = [layout, recording] + ([inputs] if inputs else [])
        with open(os.path.join(folder, "csv", name), "w") as file:
            file.write("---\n".join(parts))
    for arm, topic, definition, message in messages():
        data = io.BytesIO()
        message.serialize(data)
        name = f"{arm}_{topic}_{type(message).__name__}"
        with open(os.path.join(folder, "message", name), "wb") as file:
            file.write(bytes([arm, topic]) + definition.encode() + data.getvalue())


if __name__ == "__main__":
    main()
