#!/usr/bin/python3
"""The live nodes outlive their roscore: after another one has started in its place, new publishers and listeners find them."""
import os
import signal
import socket
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import tree  # noqa: E402

FRAMES = 240
# What the rig says goes elsewhere: beside it the nodes hear our feeder.
RIG_ELSEWHERE = ["/payload:=/rig/payload"] + [f"/mocap/{body}/pose:=/rig/{body}/pose"
                                              for body in ["base", "ring_1", "ring_2", "ring_3", "ring_4"]]


def feed():
    """In the environment of a roscore: publishes frames, counts the answers, and looks for the rig's topics."""
    sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "../ros"))
    import rospy
    from feeder import NODE, Feeder, Listener
    from geometry_msgs.msg import PoseStamped
    from std_msgs.msg import Float64
    from std_srvs.srv import Trigger
    rospy.init_node("restart_feeder", anonymous=True)
    listener = Listener()
    payload = rospy.Publisher("/payload", Float64, queue_size=1, latch=True)
    payload.publish(0.0)
    of_rig = []
    rospy.Subscriber("/rig/ring_4/pose", PoseStamped, of_rig.append)
    feeder = Feeder()
    estimator_and_recorder = lambda: all(p.get_num_connections() >= 2 for p in feeder.publishers.values())
    if not listener.wait(estimator_and_recorder, 20.0):
        sys.exit("a node does not listen")
    reset = rospy.ServiceProxy(NODE + "/reset", Trigger)
    diagnose = rospy.ServiceProxy("/softarm_diagnose/diagnose", Trigger)
    for service in [reset, diagnose]:
        service.wait_for_service(10.0)
    if not reset().success:
        sys.exit("the service /reset refuses")
    feeder.feed(FRAMES)
    answer = diagnose()
    if not answer.success:
        sys.exit("the service /diagnose refuses: " + answer.message)
    if not listener.wait(lambda: of_rig, 10.0):
        sys.exit("nothing comes of the rig")
    listener.wait(lambda: listener.count() >= FRAMES // 2, 10.0)
    print(f"{listener.count()} answers to {FRAMES} frames")
    sys.exit(0 if listener.count() >= FRAMES // 2 else "too few answers")


class Graph:
    def __init__(self, source, build):
        self.source = source
        self.setup = os.path.join(build, "devel/setup.bash")
        self.log = open(os.path.join(build, "roscore_restart.log"), "w+", encoding="utf-8")
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.env = {**os.environ, "PATH": "/usr/sbin:/usr/bin:/sbin:/bin:" + os.environ["PATH"], "ROS_IP": "127.0.0.1",
                    "ROS_MASTER_URI": f"http://127.0.0.1:{self.port}", "ROS_HOME": os.path.join(build, "roscore_restart"),
                    "ROSCONSOLE_FORMAT": "${node}: ${message}"}
        self.env.pop("ROS_HOSTNAME", None)
        self.running = []

    def start(self, command):
        process = subprocess.Popen(["bash", "-c", f"source '{self.setup}' && exec {command}"], env=self.env, stdout=self.log,
                                   stderr=self.log, start_new_session=True)
        self.running.append(process)
        return process

    def core(self):
        process = self.start(f"roscore -p {self.port}")
        end = time.time() + 60
        while time.time() < end:
            with socket.socket() as probe:
                if probe.connect_ex(("127.0.0.1", self.port)) == 0:
                    return process
            time.sleep(0.1)
        sys.exit("the roscore does not come")

    def stop(self, process):
        try:
            os.killpg(process.pid, signal.SIGINT)
            process.wait(30)
        except (ProcessLookupError, subprocess.TimeoutExpired):
            pass
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass

    def fed(self):
        return self.start(f"/usr/bin/python3 '{os.path.realpath(__file__)}' --feed").wait(120)

    def said(self):
        self.log.flush()
        with open(self.log.name, encoding="utf-8", errors="replace") as text:
            return text.read()


def main():
    source, build = tree.directories()
    if not os.path.exists(os.path.join(build, "devel/setup.bash")):
        tree.skip("built without ROS")
    graph = Graph(source, build)
    try:
        core = graph.core()
        programs, arm = f"{build}/devel/lib/softarm_estimator", f"_arm:='{source}/test/ros/light_arm.yaml'"
        nodes = [graph.start(f"'{programs}/estimator_node' __name:=softarm_estimator {arm}"),
                 graph.start(f"'{programs}/diagnose_node' __name:=softarm_diagnose {arm} _minutes:=0.05 _trial_s:=1 "
                             f"_program:='{source}/test/ros/diagnose_stand_in' _out:='{graph.env['ROS_HOME']}/diagnoses'"),
                 graph.start(f"'{programs}/simulator_node' __name:=softarm_rig "
                             f"_scenario:='{source}/config/scenarios/demo.yaml' {' '.join(RIG_ELSEWHERE)}")]
        first = graph.fed()
        graph.stop(core)
        time.sleep(2.5)  # it is missed
        graph.core()
        time.sleep(3.0)
        second = graph.fed()
        said = graph.said()
        print(said)
        problems = []
        if first != 0:
            problems.append("no answers before the restart")
        if second != 0:
            problems.append("no answers after the restart")
        if any(node.poll() is not None for node in nodes):
            problems.append("a node has ended")
        for name in ("/softarm_estimator", "/softarm_diagnose", "/softarm_rig"):
            lines = [line for line in said.splitlines() if name + ": " in line]
            problems += [f"{name} does not say: {words}" for words in ("the roscore does not answer", "registered with it again")
                         if not any(words in line for line in lines)]
        sys.exit("; ".join(problems) if problems else 0)
    finally:
        for process in graph.running:
            graph.stop(process)


if __name__ == "__main__":
    if "--feed" in sys.argv:
        feed()
    main()
