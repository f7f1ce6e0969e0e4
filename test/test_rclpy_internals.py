# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What rclpy does not promise and the node relies on, tried with the rclpy that is installed: a failure names what a new version has changed."""

import os
from contextlib import ExitStack

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"  # before anything of ROS is loaded

import rclpy  # noqa: E402
from lifecycle_msgs.msg import Transition  # noqa: E402
from lifecycle_msgs.srv import ChangeState  # noqa: E402
from rclpy.lifecycle import LifecycleNode  # noqa: E402
from rclpy.serialization import deserialize_message, serialize_message  # noqa: E402
from ros_bench import fresh_domain  # noqa: E402
from std_msgs.msg import Float64  # noqa: E402
from support import wait_for  # noqa: E402

from bearing_sim.ros import rclpy_internals  # noqa: E402


@pytest.fixture(scope="module")
def node():
    """A lifecycle node that nobody spins."""
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=fresh_domain())
    made = LifecycleNode("internals", context=context, enable_rosout=False)
    yield made
    made.destroy_node()
    rclpy.shutdown(context=context)


def test_a_serialised_message_is_published_through_the_handle_and_taken_from_the_handle_without_an_executor(node):
    publisher = node.create_publisher(Float64, "number", 10)
    subscription = node.create_subscription(Float64, "number", lambda _: None, 10, raw=True)
    with ExitStack() as borrowed:
        publish, take = rclpy_internals.raw_publish(publisher, borrowed), rclpy_internals.taker(subscription, borrowed)
        assert publish != publisher.publish, "rclpy's publisher handle has lost publish_raw: messages are published at a higher cost"
        wait_for(publisher.get_subscription_count)
        assert take() is None, "take_message of rclpy's subscription handle returns None if nothing has come"
        publish(serialize_message(Float64(data=7.0)))
        found = []
        wait_for(lambda: found or found.extend(filter(None, [take()])) or found)
        assert deserialize_message(found[0][0], Float64).data == 7.0 and "received_timestamp" in found[0][1]


def test_the_callback_of_a_service_that_rclpy_has_made_can_be_replaced_and_a_transition_that_is_none_is_no_success(node):
    called = []

    def wrapped(change_state):
        def answer(request, response):
            called.append(change_state)
            try:
                return change_state(request, response)
            except rclpy_internals.RclError as error:  # up to ROS 2 Jazzy; later ones answer by themselves
                assert isinstance(error, RuntimeError)
                return response

        return answer

    rclpy_internals.wrap_service(node, "change_state", wrapped)
    (service,) = (service for service in node.services if service.srv_name.endswith("/change_state"))
    request = ChangeState.Request(transition=Transition(id=Transition.TRANSITION_ACTIVATE))
    assert not service.callback(request, ChangeState.Response()).success and len(called) == 1


def test_rclpy_has_its_executor_of_events():
    executor = rclpy_internals.make_executor()
    executor.shutdown()
    assert type(executor).__name__ == "EventsExecutor", "without it the node needs twice the processor time"


def test_no_other_module_uses_what_rclpy_does_not_promise():
    folder = os.path.dirname(rclpy_internals.__file__)
    used = ("rclpy.impl", "rclpy.experimental", ".take_message", ".publish_raw", ".callback =", ".handle.", "import _rclpy")
    for name in os.listdir(folder):
        if name.endswith(".py") and name != "rclpy_internals.py":
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                text = file.read()
            assert not [each for each in used if each in text], name
