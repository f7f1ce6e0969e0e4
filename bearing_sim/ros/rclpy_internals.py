# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The parts of rclpy that are used here although rclpy does not promise them; everything else of it is used as documented.

``test/test_rclpy_internals.py`` tries each of them with the rclpy that is installed, and names the one that has changed.
"""

from collections.abc import Callable
from contextlib import ExitStack

from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.subscription import Subscription

RclError = rclpy_implementation.RCLError
"""What the library below rclpy raises, such as for a full queue or a transition that a state does not have; a RuntimeError."""


def make_executor() -> Executor:
    """Return rclpy's EventsExecutor if there is one, which does not rebuild its wait set at every message.

    It must spin on the main thread: elsewhere it delivers nothing.
    """
    try:
        from rclpy.experimental import EventsExecutor
    except ImportError:
        return SingleThreadedExecutor()
    return EventsExecutor()


def wrap_service(node: Node, name: str, wrapped: Callable[[Callable], Callable]) -> None:
    """Replace the callback of a service that rclpy has made for a node, named by its last part, by what ``wrapped`` makes of it."""
    (service,) = (service for service in node.services if service.srv_name.endswith(f"/{name}"))
    service.callback = wrapped(service.callback)


def raw_publish(publisher: Publisher, borrowed: ExitStack) -> Callable[[bytes], None]:
    """Return the function that publishes a serialised message, valid until ``borrowed`` is closed.

    This is what `Publisher.publish` calls in the end.  Entering the handle once instead of at every message saves a sixth of the cost.
    """
    handle = publisher.handle
    if not hasattr(handle, "publish_raw"):  # another version of rclpy
        return publisher.publish
    borrowed.enter_context(handle)
    return handle.publish_raw


def taker(subscription: Subscription, borrowed: ExitStack, serialised: bool = True) -> Callable[[], tuple[object, dict] | None]:
    """Return the function that takes a message which has come and what the middleware knows about it, None if there is none.

    Parameters
    ----------
    subscription : of a node that no executor spins.
    borrowed : the function is valid until this is closed.
    serialised : whether it returns the bytes of the message; otherwise the message.
    """
    handle, kind = subscription.handle, subscription.msg_type
    borrowed.enter_context(handle)  # once instead of at every look
    return lambda: handle.take_message(kind, serialised)
