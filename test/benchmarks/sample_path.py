# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The way of one sample, counted: ``python test/benchmarks/sample_path.py`` from the root of the tree to count.

A node runs in this process with a recording and a subscriber.  Again and again, the bytes of a shaft speed message go into the subscription's
callback, the solver computes a tick, the sample is published, and a review passes it on to the recorder's thread, which writes it.
Counted are calls of functions of this package, by thread, comprehensions left out; each function that works on batches counts once.  What
reviews do besides (monitors, health, diagnostics) and the recording of the input message are no part of the way.  Copies are the buffers
beyond the first that hold the whole sample's numbers.
"""

import argparse
import os
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path

ROOT = Path.cwd()
sys.path.insert(0, str(ROOT))
PACKAGE = str(ROOT / "bearing_sim") + os.sep
SAMPLES = 100
RATE = 0.05  # of real time, so that every sample goes its way alone
CARRIERS = ("runtime/", "ros/", "recording/")  # from the solver to the file
EXCLUDED_FILES = ("watchers/monitoring/", "runtime/monitor.py", "runtime/alarm.py", "runtime/cusum.py", "runtime/residual.py", "runtime/health.py")
EXCLUDED_CALLS = {  # of reviews and of the input's own recording, under the names of all versions
    *("_report", "condition", "_events", "news", "look", "update_subscribed", "_state_event", "_begin_late", "_start_late", "_join_governor"),
    *("_open_those_warm", "_open_warm_bearings", "_report_is_due", "follows_clock", "tell_news", "report_news", "_flow", "check"),
    *("write_inputs", "write_event", "write_diagnostics"),
    *("<genexpr>", "<listcomp>", "<dictcomp>"),
}
counting = False
counts: Counter[tuple[str, str]] = Counter()  # (thread, function)
buffers: set[int] = set()
needle = None  # a number that only the sample that is followed has
_state = threading.local()


def profile(frame, event, argument):
    """Count calls of the package's functions, and the buffers that they are given."""
    if event not in ("call", "return"):
        return
    name = frame.f_code.co_filename
    if not name.startswith(PACKAGE):
        return
    if event == "return":
        if getattr(_state, "excluded", None) is frame:
            _state.excluded = None
        if counting and needle is not None and name[len(PACKAGE) :].startswith(CARRIERS):
            see(argument)
        return
    if getattr(_state, "excluded", None) is not None:
        return
    inner = name[len(PACKAGE) :]
    is_of_another_record = type(frame.f_locals.get("record")).__name__ in ("ReceivedInputs", "Event", "Report")
    if inner.startswith(EXCLUDED_FILES) or frame.f_code.co_name in EXCLUDED_CALLS or is_of_another_record:
        _state.excluded = frame
        return
    if counting:
        counts[threading.current_thread().name, f"{inner}:{frame.f_code.co_name}:{frame.f_code.co_firstlineno}"] += 1
        if needle is not None and inner.startswith(CARRIERS):
            for value in list(frame.f_locals.values()):
                see(value)


def see(value) -> None:
    """Note the buffer of an array that holds the sample that is followed."""
    import numpy as np

    for array in value if isinstance(value, (list, tuple)) and len(value) < 20 else (value,):
        if isinstance(array, np.ndarray) and array.nbytes >= 200 and array.nbytes % 8 == 0 and array.dtype.kind in "Vf":
            numbers = np.frombuffer(array.tobytes(), np.float64)
            if (numbers == needle).any():
                while isinstance(array.base, np.ndarray):
                    array = array.base
                buffers.add(array.__array_interface__["data"][0])


def main() -> None:
    """Count and print."""
    global counting, needle
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--functions", action="store_true", help="list every function with its calls per sample")
    options = parser.parse_args()
    folder = Path(tempfile.mkdtemp())
    os.environ |= {
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DOMAIN_ID": os.environ.get("ROS_DOMAIN_ID", str(50 + os.getpid() % 50)),
        "ROS_LOG_DIR": str(folder),
    }
    import rclpy
    from rclpy.serialization import serialize_message
    from rclpy.task import Future
    from sensor_msgs.msg import JointState
    from std_msgs.msg import Float64

    parameters = ["record:=" + str(folder / "run.mcap"), "publish_rate:=200.0", "sample_rate:=200.0", "scene:=deng2017_table1"]
    rclpy.init(args=["node", "--ros-args", *(word for text in parameters for word in ("-p", text))])
    from bearing_sim.ros.node import BearingNode

    threading.setprofile(profile)
    node = BearingNode(Future())
    for timer in list(node.timers):
        timer.cancel()
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(node)
    node.start()
    listener = rclpy.create_node("listener")
    listener.create_subscription(Float64, "cage_slip", lambda message: None, 10)
    bearing = node.bearings[0]
    while bearing.live is None:
        node._review()
        time.sleep(0.05)
    live = bearing.live
    solver = getattr(live, "solver", None) or live.runner
    solver._pacer.rate = RATE
    take = next(entry.callback for entry in node.subscriptions if entry.topic_name == "/shaft_speed")
    speed = 1000.0

    def stamped():
        nonlocal speed
        speed += 0.001
        message = JointState(name=["shaft"], position=[0.0], velocity=[speed], effort=[0.0])
        message.header.stamp = node.get_clock().now().to_msg()
        return serialize_message(message)

    def newest():
        return vars(solver).get("newest", vars(solver).get("_newest"))  # without a call of the package

    def turn():
        """Send a message and let its sample go all its way."""
        before, data = newest(), stamped()
        take(data)
        end = time.monotonic() + 5.0
        while newest() is before and time.monotonic() < end:
            time.sleep(0.0005)
        executor.spin_once(timeout_sec=0.02)
        node._review()

    for _ in range(50):
        turn()
    counting = True
    sys.setprofile(profile)
    for _ in range(SAMPLES):
        turn()
    sys.setprofile(None)
    time.sleep(0.5)
    counting = False
    copies = []
    for _ in range(10):  # a sample is followed by its shaft speed, which no other one has
        buffers.clear()
        counting, needle = True, speed + 0.001
        sys.setprofile(profile)
        turn()
        turn()
        sys.setprofile(None)
        counting = False
        time.sleep(0.2)
        copies.append(len(buffers) - 1)
    sums: Counter[str] = Counter()
    for (thread, function), count in sorted(counts.items()):
        calls = count / SAMPLES
        if calls < 0.3:  # now and then, not with every sample
            continue
        sums[thread] += max(1, round(calls))
        if options.functions:
            print(f"{calls:8.2f}  {thread}  {function}")
    for thread, calls in sums.items():
        print(f"{thread:40} {calls:4}")
    print(f"own calls of one sample {sum(sums.values())}, threads {len(sums)}, whole copies in the node {min(copies)}")
    node.close()
    os._exit(0)


if __name__ == "__main__":
    main()
