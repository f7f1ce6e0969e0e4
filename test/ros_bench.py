# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A running bearing_node and a client of it in this process, connected over DDS on the loopback interface only."""

import os
import random
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"  # before anything of ROS is loaded

import rclpy  # noqa: E402
from preloaded import PreloadingServer  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rclpy.qos import qos_profile_sensor_data  # noqa: E402

from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.messages.diagnostics import SUBJECTS, UNUSED, WHOLE, events_of  # noqa: E402
from bearing_sim.ros.messages import message, message_class  # noqa: E402
from bearing_sim.ros.shared_memory import remove_unfinished_ports  # noqa: E402
from bearing_sim.simulation import Inputs  # noqa: E402

GOOD = Inputs(shaft_speed=1000.0, load_y=800.0, load_z=0.0, oil_temperature=393.15)
PATIENCE = 30.0  # [s] how long to wait for what should come at once: the machine may be busy
_COMPILING = 100.0  # [s] how long the node may take to its start when its code has to be compiled
_REPOSITORY = Path(__file__).resolve().parent.parent
_NODE = "bearing_sim.ros.node"
_PRELOADED = [_NODE, "bearing_sim.ros.player", "loaded_model"]


_DOMAINS = list(range(1, 101))  # higher ones collide with ports that the system hands out
random.SystemRandom().shuffle(_DOMAINS)


def fresh_domain() -> int:
    """Return a ROS_DOMAIN_ID that no test of this process has had and in which nobody is heard: two nodes in one answer for each other."""
    while _DOMAINS:
        domain = _DOMAINS.pop()
        if not _inhabited(domain):
            return domain
    raise RuntimeError("every ROS_DOMAIN_ID of 1 to 100 has been used")


def _inhabited(domain: int) -> bool:
    """Return whether some participant has one of the first ports of a domain (DDSI-RTPS 2.5, section 9.6.2.3)."""
    for port in (0, 10, 11, 12, 13):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("", 7400 + 250 * domain + port))
            except OSError:
                return True
    return False


class NodeProcess:
    """``python -m MODULE ARGUMENTS`` under a watchdog that kills it, with everything it prints kept in a file.

    It is forked from a process that has imported what nodes need and loaded their compiled code, unless it gets an environment of its
    own or is ``from_scratch``.
    """

    _server = None

    def __init__(
        self, folder: Path, domain: int, *arguments: str, module: str = _NODE, limit: int = 150, from_scratch: bool = False, **environment: str
    ):
        self.log = folder / f"{module.rpartition('.')[2]}_{time.monotonic_ns()}.log"
        from_scratch = from_scratch or bool(environment)
        environment = {**os.environ, "ROS_DOMAIN_ID": str(domain), "ROS_LOG_DIR": str(folder / "ros_log"), **environment}
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, [str(_REPOSITORY), environment.get("PYTHONPATH")]))
        with open(self.log, "wb") as log:
            if from_scratch:
                command = ["timeout", "-s", "KILL", str(limit), sys.executable, "-m", module, *arguments]
                self.process = subprocess.Popen(command, env=environment, stdout=log, stderr=subprocess.STDOUT, cwd=folder)
            else:
                if NodeProcess._server is None:
                    NodeProcess._server = PreloadingServer(_PRELOADED, [_REPOSITORY, _REPOSITORY / "test"])
                self.process = NodeProcess._server.start(module, *arguments, output=log, folder=folder, environment=environment, limit=limit)

    def end(self, number: int = signal.SIGTERM) -> int:
        """Send a signal and return the exit code."""
        if self.process.poll() is None:
            if number == signal.SIGKILL:
                os.killpg(self.process.pid, number)  # the watchdog leads a process group of its own, the node is in it
            else:
                self.process.send_signal(number)
        return self.wait()

    def wait(self) -> int:
        """Return the exit code when the process has ended."""
        return self.process.wait(PATIENCE)

    @property
    def text(self) -> str:
        """Everything printed so far."""
        return self.log.read_text(errors="replace")


class Client:
    """Publishes inputs, keeps outputs, calls services."""

    def __init__(self, domain: int, namespace: str = "", scalar: bool = False):
        remove_unfinished_ports()  # of nodes that tests have killed
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=domain)
        self.node = rclpy.create_node("test_client", context=self.context, namespace=namespace, enable_rosout=False)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        # What is heard is taken without the executor, which handles one message in the time of a dozen takes: a busy machine falls behind.
        self._ears = rclpy.create_node("test_ears", context=self.context, namespace=namespace, enable_rosout=False, start_parameter_services=False)
        self.received = {name: [] for name in [*topics.OUTPUTS, "diagnostics"]}
        self._reported: dict[str, set[str]] = {}  # subjects of the newest report, by component
        self._callers = {}  # clients of services, by name
        self._types = {name: topics.INPUTS[name].ros_type for name in ("shaft_speed", "radial_load")}
        if scalar:
            self._types = dict.fromkeys(self._types, "std_msgs/msg/Float64")
        self.publishers = {name: self.node.create_publisher(message_class(kind), name, qos_profile_sensor_data) for name, kind in self._types.items()}
        for name, topic in topics.OUTPUTS.items():
            self.listen(topic.ros_type, name, self.received[name].append)
        name, kind = topics.DIAGNOSTICS
        self.listen(kind, f"/{name}", self._hear_diagnostics)

    def close(self):
        self.executor.shutdown()
        self.node.destroy_node()
        self._ears.destroy_node()
        rclpy.shutdown(context=self.context)

    def listen(self, ros_type: str, topic: str, taken) -> None:
        """Call ``taken`` with every message of a topic, while spinning."""
        self._ears.create_subscription(message_class(ros_type), topic, taken, 200)

    def hear(self) -> None:
        """Take all messages that have come."""
        for subscription in self._ears.subscriptions:
            with subscription.handle:
                while (taken := subscription.handle.take_message(subscription.msg_type, False)) is not None:
                    subscription.callback(taken[0])

    def spin(self, seconds: float) -> None:
        """Let messages come in for a while."""
        end = time.monotonic() + seconds
        while (rest := end - time.monotonic()) > 0:
            self.executor.spin_once(timeout_sec=min(rest, 0.01))
            self.hear()

    def spin_until(self, condition, what: str, process: NodeProcess, patience: float = PATIENCE) -> None:
        """Let messages come in until the condition holds; fail with a clear word when it does not."""
        end = time.monotonic() + patience
        while not condition():
            assert time.monotonic() < end, f"waited {patience} s in vain: {what}\n{process.text}"
            assert process.process.poll() is None, f"the node ended early: {what}\n{process.text}"
            self.executor.spin_once(timeout_sec=0.02)
            self.hear()

    def wait_until_matched(self, process: NodeProcess) -> None:
        """Wait until the node listens and can be heard."""
        self.spin_until(lambda: all(p.get_subscription_count() for p in self.publishers.values()), "the node subscribes", process, _COMPILING)

    def send(self, channel: str, stamp_ns: int | None = None, **values: float) -> None:
        """Publish one message; ``values`` replace those of `GOOD`."""
        stamp_ns = self.node.get_clock().now().nanoseconds if stamp_ns is None else stamp_ns
        inputs = GOOD._replace(**values)
        if self._types[channel] == "std_msgs/msg/Float64":
            fields = {"data": inputs.shaft_speed if channel == "shaft_speed" else inputs.load_y}
        else:
            fields = topics.INPUTS[channel].message(stamp_ns, inputs)
        self.publishers[channel].publish(message(self._types[channel], fields))

    def drive(self, seconds: float, rate: float = 50.0, **values: float) -> None:
        """Publish both inputs at a rate for a while."""
        end, due = time.monotonic() + seconds, time.monotonic()
        while time.monotonic() < end:
            self.send("shaft_speed", **values)
            self.send("radial_load", **values)
            due = max(due + 1 / rate, time.monotonic())
            self.spin(due - time.monotonic())

    def drive_until(self, condition, what: str, process: NodeProcess, rate: float = 50.0, **values: float) -> None:
        """Publish both inputs at a rate until the condition holds."""
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end, f"waited {PATIENCE} s in vain: {what}\n{self.statuses()[-12:]}\n{process.text}"
            assert process.process.poll() is None, f"the node ended early: {what}\n{process.text}"
            self.drive(0.1, rate, **values)

    def _hear_diagnostics(self, report) -> None:
        """Keep a report of diagnostics; each, in whatever state of the node, must have its subjects once, in order, and all that it ever had."""
        component, subjects = report.status[0].name.partition(": ")[0], [status.name.rpartition(": ")[2] for status in report.status]
        assert subjects == [name for name in (WHOLE, *(subject.name for subject in SUBJECTS), UNUSED) if name in subjects], subjects
        assert {WHOLE, "run", "slip", UNUSED} | self._reported.get(component, set()) <= set(subjects), "a status that is not reported turns stale"
        self._reported[component] = set(subjects)
        self.received["diagnostics"].append(report)

    def is_calm(self, report=-1):
        """Whether the given report of diagnostics tells of nothing but limits of validity, which hold as long as the condition does."""
        told = self.received["diagnostics"][report].status[1:]
        return not any(status.level[0] for status in told if not status.name.endswith(": validity"))

    def statuses(self, since: int = 0) -> list[tuple[int, str, str]]:
        """Return (level, ``component: kind``, text) of every event in the diagnostics from the message number ``since`` on."""
        statuses = (status for report in self.received["diagnostics"][since:] for status in report.status)
        told = ((status.name.partition(": ")[0], event) for status in statuses for event in events_of(0.0, status))
        return [(event.level, f"{component}: {event.kind}", event.text) for component, event in told]

    def values(self) -> dict[str, str]:
        """Return the numbers of the newest diagnostics; none before the first."""
        return {pair.key: pair.value for report in self.received["diagnostics"][-1:] for pair in report.status[0].values}

    def call(self, kind, service: str, request, process: NodeProcess):
        """Call a service of bearing_node, or one by its full name, and return its response.

        Clients are kept: a server that has not discovered a new client's reader yet loses the response.
        """
        is_new = service not in self._callers
        if is_new:
            self._callers[service] = self.node.create_client(kind, service if service.startswith("/") else f"bearing_node/{service}")
        caller = self._callers[service]
        if is_new or not caller.service_is_ready():
            self.spin_until(caller.service_is_ready, f"the service {service} is there", process)
            self.spin(0.3)
        future = caller.call_async(request)
        self.spin_until(future.done, f"the service {service} answers", process)
        return future.result()
