# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The player without a network: in which order it publishes, and that it ends when it is asked to.  `test_node_sim_time` has it play for a node."""

import io
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="the player needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from bearing_sim.ros.player import Player, ScheduledMessage, Timeline, progress_of, schedule  # noqa: E402

MESSAGES = [ScheduledMessage(0.02 * k, "shaft_speed", (300.0 + k,), 10**9 + k) for k in range(5)]


class Publisher:
    """Keeps what it is given."""

    def __init__(self):
        self.published = []

    def publish(self, message):
        self.published.append(message)

    def wait_for_all_acked(self, limit):
        return True

    def get_subscription_count(self):
        return 1


class Node:
    """A node with one publisher for each topic, by its name, and a clock that stands still."""

    def __init__(self):
        self.publishers = {}

    def create_publisher(self, kind, topic, qos):
        return self.publishers.setdefault(topic, Publisher())

    def create_service(self, kind, name, serve):
        self.pause = serve

    def get_clock(self):
        return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=5 * 10**9))


def played(wants_end, rate=1.0, messages=MESSAGES):
    """Return what a player returned and published of some messages, the player, and the times that it showed as its progress."""
    node, shown = Node(), []
    player = Player(node, lambda: wants_end(node), ["shaft_speed"], Timeline(rate), scalar=True)
    return player.play(messages, shown.append), [each.data for each in node.publishers["shaft_speed"].published], player, shown


def test_every_message_is_published_once_in_order_and_none_before_its_time():
    done, published, player, shown = played(lambda node: False)
    assert done and published == [300.0, 301.0, 302.0, 303.0, 304.0]
    assert player.sent == {"shaft_speed": 5} and player.lateness >= 0.0 and player.reached == shown[-1] == MESSAGES[-1].time


class Terminal(io.StringIO):
    """A terminal that keeps what it shows."""

    def isatty(self):
        return True


@pytest.mark.parametrize("total", [0.3, 12.5])
def test_a_terminal_shows_a_bar_that_ends_when_all_is_played_and_not_before(monkeypatch, total):
    monkeypatch.setattr("sys.stderr", terminal := Terminal())
    with progress_of("playing a log", total) as show:
        for time in np.linspace(0.0, max(total - 1.0, 0.0), 50).tolist():
            show(time)
        assert "playing a log" in terminal.getvalue() and "100%" not in terminal.getvalue()
        show(total)
    assert "100%" in terminal.getvalue()


def test_a_log_of_one_instant_is_shown_too(monkeypatch):
    monkeypatch.setattr("sys.stderr", Terminal())
    with progress_of("playing a log", 0.0) as show:
        show(0.0)


@pytest.mark.parametrize("count", [0, 1, 3])
@pytest.mark.parametrize("messages", [MESSAGES, [each._replace(time=0.0) for each in MESSAGES]], ids=["one after the other", "all at once"])
def test_a_player_that_is_asked_to_end_publishes_no_further_message(messages, count):
    done, published, *_ = played(lambda node: len(node.publishers["shaft_speed"].published) >= count, messages=messages)
    assert not done and len(published) == count


def test_a_player_that_is_asked_to_end_does_not_wait_for_its_next_message():
    asked = []

    def wants_end(node):
        asked.append(len(node.publishers["shaft_speed"].published))
        return bool(asked[-1])

    done, published, player, _ = played(wants_end, rate=1e-3)  # the second message is due in 20 s
    assert not done and published == [300.0] and asked.count(1) < 5


def test_messages_are_due_by_their_log_times_unless_stamps_are_wanted():
    series = SimpleNamespace(log_times=[20, 30, 40], stamps=[7, 9, 8], values=[(1.0,), (2.0,), (3.0,)])
    other = SimpleNamespace(log_times=[10, 35], stamps=[8, 12], values=[(4.0,), (5.0,)])
    log = SimpleNamespace(series={"shaft_speed": series, "radial_load": other})
    assert [(round(1e9 * each.time), each.values[0], each.stamp_ns) for each in schedule(log)] == [
        (0, 4.0, 8), (10, 1.0, 7), (20, 2.0, 9), (25, 5.0, 12), (30, 3.0, 8),
    ]  # fmt: skip
    by_stamps = [(round(1e9 * each.time), each.values[0]) for each in schedule(log, by_stamps=True)]
    assert by_stamps == [(0, 1.0), (1, 4.0), (2, 2.0), (2, 3.0), (5, 5.0)], "3.0 is stamped before 2.0 and due together with it"
