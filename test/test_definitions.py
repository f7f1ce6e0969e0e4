# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Messages decoded by the definition in their recording, against messages that rosbags serialises; and definitions that strangers wrote."""

import struct

import numpy as np
import pytest
from rosbags.typesys import get_types_from_msg
from rosbags.typesys.base import normalize_fieldname
from test_cdr import STORE, random_message

from bearing_sim.files.limits import VARIABLE
from bearing_sim.messages.cdr import CdrError
from bearing_sim.messages.definitions import DefinitionError, decoder

SPLIT = "=" * 80 + "\n"


def assert_same(found, expected):
    """Hold a decoded message, or a part of one, against the object that was serialised."""
    if hasattr(expected, "__msgtype__"):
        for name, _ in STORE.fielddefs.get(expected.__msgtype__, (0, [(name, 0) for name in vars(found)]))[1]:
            if name != "structure_needs_at_least_one_member":
                assert_same(getattr(found, name), getattr(expected, normalize_fieldname(name)))
    elif isinstance(expected, np.ndarray):
        np.testing.assert_array_equal(found, expected)
    elif isinstance(expected, list):
        assert len(found) == len(expected)
        for one, other in zip(found, expected):
            assert_same(one, other)
    else:
        assert found == expected


@pytest.mark.parametrize("is_big_endian", [False, True])
def test_every_standard_message_is_decoded_to_what_rosbags_serialised_by_its_own_text(is_big_endian):
    for seed, kind in enumerate(sorted(STORE.types)):
        text, _ = STORE.generate_msgdef(kind, ros_version=2)
        message, _ = random_message(np.random.default_rng(seed), kind)
        data = bytes(STORE.serialize_cdr(message, kind, little_endian=not is_big_endian))
        assert_same(decoder(kind, "ros2msg", text.encode())(data), message)


def test_messages_of_ros_1_have_no_padding_and_no_zero_at_the_end_of_a_text():
    kind = "sensor_msgs/msg/JointState"
    text = b"time stamp\nstring frame_id\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"
    for seed in range(20):
        message, _ = random_message(np.random.default_rng(seed), kind)
        ours = decoder(kind, "ros1msg", text)(bytes(STORE.serialize_ros1(message, kind)))
        assert (ours.stamp.sec, ours.frame_id, ours.name) == (message.header.stamp.sec, message.header.frame_id, message.name)
        np.testing.assert_array_equal(ours.effort, message.effort)


def test_constants_defaults_bounds_and_comments_are_no_fields():
    text = 'int32 A=5\nstring B = "x#y"  # c\n# d\n\nstring<=10 name "a=b"\nfloat64[<=3] x [1.0, 2.0]\nuint8[2] y\tspan class\nCell cell\n'
    text = text.replace("\tspan class", "") + SPLIT + "MSG: drive_msgs/Cell\r\nint16 z -1\n"
    types = get_types_from_msg("string name\nfloat64[] x\nuint8[2] y\ndrive_msgs/Cell cell\n", "drive_msgs/msg/State")
    store = type(STORE)()
    store.register(types | get_types_from_msg("int16 z\n", "drive_msgs/msg/Cell"))
    state = store.types["drive_msgs/msg/State"]("n", np.array([3.0]), np.array([7, 8], np.uint8), store.types["drive_msgs/msg/Cell"](-9))
    data = bytes(store.serialize_cdr(state, "drive_msgs/msg/State"))
    assert_same(decoder("drive_msgs/msg/State", "ros2msg", text.encode())(data), state)
    idl = "module drive_msgs { module msg { struct Cell { short z; }; }; };"
    assert decoder("drive_msgs/msg/Cell", "ros2idl", idl.encode())(b"\0\1\0\0\xf7\xff").z == -9


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("A a\n" + SPLIT + "MSG: p/A\nB[] b\n" + SPLIT + "MSG: p/B\nA[] a\n", "contains itself"),
        ("".join(f"float64 x{k}\n" for k in range(100_000)), "definition_fields=NUMBER"),
        ("N0 a\n" + "".join(f"{SPLIT}MSG: p/N{k}\nN{k + 1} a\n" for k in range(100)) + f"{SPLIT}MSG: p/N100\nbyte a\n", "definition_depth=NUMBER"),
        ("Nowhere a\n", "p/Nowhere is not defined"),
        ("float64 x\nfloat64 x\n", "two fields of one name"),
        ("float64 9x\n", "cannot parse 'float64 9x'"),
        ("wstring x\n", "wstring"),
        ("# " + "x" * 2_000_000, "definition=NUMBER"),
        ("float64 x\n" + SPLIT + "float64 y\n", "without a line such as MSG"),
    ],
    ids=["cycle", "fields", "depth", "unknown type", "one name twice", "no name", "wstring", "length", "nameless part"],
)
def test_a_definition_that_cannot_be_used_is_refused_with_the_reason(text, words):
    with pytest.raises(DefinitionError, match=words):
        decoder("p/msg/Type", "ros2msg", text.encode())


@pytest.mark.parametrize(
    ("text", "data", "words"),
    [
        ("float64[] x\n", struct.pack("<I", 2**32 - 1), "end within"),
        ("string x\n", struct.pack("<I", 2**31), "end within"),
        ("B[] x\n" + SPLIT + "MSG: p/B\nuint8[1] y\n", struct.pack("<I", 2**32 - 1), "message_items=NUMBER"),
        ("B[1000] x\n" + SPLIT + "MSG: p/B\nC[1000] x\n" + SPLIT + "MSG: p/C\nD[1000] x\n" + SPLIT + "MSG: p/D\nuint8 x\n", b"", "end within"),
        ("uint8[4000000000] x\n", b"", "end within"),
        ("string x\n", struct.pack("<I", 3) + b"\xff\xfe\0", "not UTF-8"),
    ],
    ids=["numbers", "text", "messages of bytes", "arrays of arrays", "fixed array", "encoding"],
)
def test_no_item_of_a_message_is_made_before_its_bytes_are_known_to_be_there(text, data, words):
    with pytest.raises(CdrError, match=words):
        decoder("p/msg/Type", "ros2msg", text.encode())(b"\0\1\0\0" + data)


def test_types_within_types_that_double_at_each_level_end_with_the_message():
    text = "N0 a\nN0 b\n" + "".join(f"{SPLIT}MSG: p/N{k}\nN{k + 1} a\nN{k + 1} b\n" for k in range(29)) + f"{SPLIT}MSG: p/N29\nbyte a\n"
    with pytest.raises(CdrError, match="end within"):
        decoder("p/msg/Type", "ros2msg", text.encode())(bytes([0, 1, *[0] * 100]))


def test_a_limit_is_raised_by_its_name(monkeypatch):
    text = "".join(f"byte x{k}\n" for k in range(10_001)).encode()
    monkeypatch.setenv(VARIABLE, "definition_fields=20e3")
    assert decoder("p/msg/Type", "ros2msg", text)(b"\0\1\0\0" + b"\7" * 10_001).x10000 == 7


@pytest.mark.parametrize("head", [b"", b"\0", b"\0\2\0\0", b"\xff\xff\xff\xff"])
def test_bytes_in_another_representation_are_no_message(head):
    with pytest.raises(CdrError, match="CDR version 1"):
        decoder("std_msgs/msg/Float64", "ros2msg", b"float64 data")(head)


IDL_RULE = "=" * 80 + "\n"
WITH_INCLUDES = (
    """IDL: drive_msgs/msg/State
// generated
#include "drive_msgs/msg/Cell.idl"
#include "std_msgs/msg/Header.idl"
#ifndef GUARD
#define LONGER \\
  text
module drive_msgs {
  module msg {
    enum Mode { @value(0) IDLE, RUN };
    typedef double pair[2];
    module State_Constants { const uint8 LIMIT = 2; };
    @verbatim (language="comment", text="# no directive" "#nor this")
    struct State {
      std_msgs::msg::Header header;
      @unit(value="m") drive_msgs::msg::Cell cell;
      msg::Cell other;
      Mode mode;
      pair two;
      sequence<Cell, 3> cells;
    };
  };
};
"""
    + IDL_RULE
    + "IDL: drive_msgs/msg/Cell\nmodule drive_msgs { module msg { struct Cell { short z; }; }; };\n"
)


def test_idl_with_includes_enumerations_annotations_and_relative_names_is_read():
    cell, header = b"\xf7\xff", b"\1\0\0\0\2\0\0\0\2\0\0\0f\0"
    data = b"\0\1\0\0" + header + cell + cell + b"\0" * 2 + b"\1\0\0\0" + np.array([1.5, 2.5]).tobytes() + b"\1\0\0\0" + cell
    notes = []
    found = decoder("drive_msgs/msg/State", "ros2idl", (IDL_RULE + WITH_INCLUDES).encode(), notes.append)(data)
    assert (found.header.stamp.nanosec, found.header.frame_id, found.cell.z, found.other.z, found.mode) == (2, "f", -9, -9, 1)
    assert found.two.tolist() == [1.5, 2.5] and [each.z for each in found.cells] == [-9] and not notes


@pytest.mark.parametrize("encoding, text", [("ros2idl", "module { this is none"), ("ros2msg", "float64\n"), ("protobuf", "message X {}")])
def test_of_a_known_type_whose_definition_cannot_be_parsed_that_of_ros_2_is_used_and_said(encoding, text):
    notes = []
    decode = decoder("std_msgs/msg/Float64", encoding, text.encode(), notes.append)
    assert decode(b"\0\1\0\0" + np.array([2.5]).tobytes()).data == 2.5
    assert len(notes) == 1 and "the definition of std_msgs/" in notes[0] and "that of ROS 2 Jazzy is used" in notes[0]
    with pytest.raises(DefinitionError, match="drive_msgs/"):
        decoder("drive_msgs/msg/State", encoding, text.encode(), notes.append)
