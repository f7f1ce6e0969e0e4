# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Take an MCAP file apart into sections, and verify whatever checksums it has.

A file of this version has a checksum record after each section (see `bearing_sim.recording.mcap_format`): any flipped bit of it is found, also in
an unfinished file, and what follows a damaged section is found again by the next checksum record.  In other files each record is a section of its
own, which nothing covers but the checksum of the whole data section, if the writer made one.
"""

import re
import zlib
from collections.abc import Container, Iterator
from typing import BinaryIO, NamedTuple, Protocol

from mcap.opcode import Opcode
from mcap.records import DataEnd, Footer

from bearing_sim.files.limits import RECORDING_RECORD
from bearing_sim.recording.mcap_format import (
    CHECKSUM_HEAD,
    CHECKSUM_RECORD,
    MAGIC,
    RECORD,
    checksum_record,
    packed,
    parsed,
)

_BLOCK = 1024 * 1024  # [byte] read at once
_FOOTER = len(packed(Footer(0, 0, 0)))  # [byte]
_DATA_END = packed(DataEnd(0))
_HEAD = re.compile(re.escape(CHECKSUM_HEAD))  # in zeros, which fill files after a loss of power, found ten times as fast as by bytes.find
_MOST_SEARCHED = 2000  # sections whose end is searched; a file with more of them was made to waste time
_LONGEST_SEARCH = 256 * 1024 * 1024  # [byte] in which the end of one section is searched; holes of a file may be longer
_LONGEST_SUMMARY = 4 * 1024**3  # [byte]; that of a day at 1 kHz has a quarter of it
_LONGEST_SALVAGED = 16 * 1024 * 1024  # [byte] of a damaged section that are looked at
_LONGEST_INDEX = 128 * 1024  # [byte] between the first record of a section and its checksum record; indexes of a chunk of 64 KiB are shorter
_KINDS = {
    Opcode.HEADER: "the header",
    Opcode.CHUNK: "a chunk",
    Opcode.METADATA: "a metadata record",
    Opcode.ATTACHMENT: "an attachment",
}


class Section(NamedTuple):
    """Records that stand one after the other.

    Attributes
    ----------
    data : the records.
    is_sound : whether nothing says that they are damaged; otherwise only what has a checksum of its own can be used.
    """

    data: bytes
    is_sound: bool


class Report(Protocol):
    """Takes a text that names something damaged or, if it is refused, says why something is not read."""

    def __call__(self, text: str, is_refused: bool = False) -> None: ...


class SectionReader:
    """Yields the sections of the data section of a file, and verifies its end.

    Parameters
    ----------
    stream : the file, which begins with the magic number.
    size : its length [byte].
    report : called for each damage, before the section is yielded.
    unneeded : opcodes of records that need no report if they are longer than the limit.

    Attributes
    ----------
    read : how far the file was read [byte].
    has_checksums : whether checksums cover all of it: those of sections or, after reading, that of the data section.
    is_finished : after reading: whether the file has its proper end.
    ends : why reading ended before that, or ``""``.
    """

    def __init__(self, stream: BinaryIO, size: int, report: Report, unneeded: Container[int] = ()):
        self._stream, self._size, self._report, self._unneeded = stream, size, report, unneeded
        self._longest = RECORDING_RECORD.value
        self._searched, self._left = 0, 4 * size + _BLOCK  # [byte] that searches may still look at; an honest file needs twice its size
        self.read, self.is_finished, self.ends = 0, False, ""
        self._has_sections = self._finds_checksum_record()
        self.has_checksums = self._has_sections

    def __iter__(self) -> Iterator[Section]:
        return self._sections() if self._has_sections else self._single_records()

    def _finds_checksum_record(self) -> bool:
        """Whether there is a checksum record near the beginning; not only the first one, because that may be damaged."""
        data = self._bytes(0, _BLOCK)
        return any(begin < at for at, begin, _ in _checksum_records_in(data))

    def _single_records(self) -> Iterator[Section]:
        window = _Window(self._stream, len(MAGIC), self._size)
        checksum: int | None = zlib.crc32(MAGIC)  # of the file so far; None once something was not read
        while window.has(RECORD.size):
            opcode, length = window.head(0)
            if length > self._longest and window.position + RECORD.size + length <= self._size:
                if opcode not in self._unneeded:
                    self._report(f"a record at byte {window.position} has {RECORDING_RECORD.refusal(length)}", is_refused=True)
                checksum = None
                window.skip(RECORD.size + length)
                yield Section(b"", True)
                continue
            whole = self._fits(window, 0)
            if not whole:
                break
            if opcode in (Opcode.DATA_END, Opcode.FOOTER):
                self._finish(window, checksum)
                return
            data = window.bytes(0, whole)
            checksum = None if checksum is None else zlib.crc32(data, checksum)
            window.advance(whole)
            self.read = window.position
            yield Section(data, True)
        self.read, self.ends = window.position, self._reason(window.position)

    def _sections(self) -> Iterator[Section]:
        window = _Window(self._stream, 0, self._size)
        checksum: int | None = 0  # of the file so far; None once anything is damaged
        while window.position < self._size and not window.begins_with(_DATA_END[: RECORD.size]):
            begin, length = window.position, self._section_length(window)
            if length is not None:
                data, record = window.bytes(0, length), window.bytes(length, length + CHECKSUM_RECORD.size)
                *_, expected = CHECKSUM_RECORD.unpack(record)
                checksum = None if checksum is None or zlib.crc32(data) != expected else zlib.crc32(record, zlib.crc32(data, checksum))
                window.advance(length + CHECKSUM_RECORD.size)
            else:
                checksum = None
                end, expected, after = self._next_section(begin)
                if begin == end == after:
                    self._report(f"the end of the data section, byte {begin}")
                    break
                if after == self._size:
                    self.read, self.ends = after, self._reason(begin)
                    data = self._bytes(begin, min(end, begin + _LONGEST_SALVAGED))  # its writer was stopped there, which is no damage
                    yield Section(data[len(MAGIC) :] if begin == 0 else data, False)
                    return
                window = _Window(self._stream, after, self._size)
                if end - begin > self._longest + _LONGEST_INDEX:
                    self._report(f"bytes {begin} to {end} have {RECORDING_RECORD.refusal(end - begin)}", is_refused=True)
                    yield Section(b"", False)
                    continue
                data = self._bytes(begin, end)
            self.read = window.position
            yield self._verified(begin, data, expected)
        if window.position < self._size:
            self._finish(window, checksum)
        else:
            self.ends = self._reason(window.position)

    def _section_length(self, window: "_Window") -> int | None:
        """Return the length of the section at the window, up to its checksum record; None if that does not follow soon after the first record.

        The records after the first one are small and many, and need not be told apart: the first byte of the section, which the checksum record
        repeats, is a mark that is found nowhere else.
        """
        first = len(MAGIC) if window.position == 0 else 0
        if window.has(first + RECORD.size):
            first += self._fits(window, first)
        end = window.find(checksum_record(window.position, 0)[:-4], first, first + _LONGEST_INDEX)
        return end if end is not None and window.has(end + CHECKSUM_RECORD.size) else None

    def _fits(self, window: "_Window", at: int) -> int:
        """Return the length of the record at a byte of the window, with its head; 0 if there is no whole record."""
        if not window.has(at + RECORD.size):
            return 0
        opcode, length = window.head(at)
        whole = RECORD.size + length
        return whole if opcode and length <= self._longest and window.position + at + whole <= self._size and window.has(at + whole) else 0

    def _next_section(self, begin: int) -> tuple[int, int | None, int]:
        """Find the end of a section whose records do not lead there.

        Returns
        -------
        end : of its records in the file.
        checksum : that its checksum record states; None if that was not found, and may be the last of the records.
        after : where the next section begins; the length of the file if there is none.
        """
        self._searched += 1
        for at, first, checksum in self._checksum_records(begin) if self._searched <= _MOST_SEARCHED else ():
            if first == begin:
                return at, checksum, at + CHECKSUM_RECORD.size
            if not begin < first <= at:
                continue
            self._left -= at - first
            if self._left > 0 and zlib.crc32(self._bytes(first, at)) == checksum:
                return first, None, first
        footer = self._footer()
        end = -1 if footer is None else footer.summary_start - len(_DATA_END)
        return (end, None, end) if begin <= end < self._size else (self._size, None, self._size)

    def _checksum_records(self, begin: int) -> Iterator[tuple[int, int, int]]:
        """Yield (byte of the file, first byte of its section, checksum) of whatever begins as a checksum record from a byte on."""
        data, position = b"", begin
        while position - begin < _LONGEST_SEARCH and (block := self._bytes(position + len(data), position + len(data) + _BLOCK)):
            data += block
            for at, first, checksum in _checksum_records_in(data):
                yield position + at, first, checksum
            kept = data[1 - CHECKSUM_RECORD.size :]
            position, data = position + len(data) - len(kept), kept

    def _verified(self, begin: int, data: bytes, checksum: int | None) -> Section:
        """Return a section; ``checksum`` as of `_next_section`."""
        records = data[len(MAGIC) :] if begin == 0 else data
        is_sound = checksum is not None and zlib.crc32(data) == checksum
        if not is_sound:
            kind = _KINDS.get(records[0], "a record") if records else "a record"
            self._report(f"{kind}, bytes {begin} to {begin + len(data)}")
        return Section(records, is_sound)

    def _finish(self, window: "_Window", checksum: int | None) -> None:
        """Verify what follows the data section.

        Parameters
        ----------
        window : at the end of the data section.
        checksum : of the file up to there; None if it is known to be damaged.
        """
        self.read, footer = self._size, self._footer()
        if footer is None:
            self.ends = "it is cut short, or its last bytes are not the end of an MCAP file"
            return
        self.is_finished = True
        begin = window.position
        if window.begins_with(_DATA_END[: RECORD.size]) and window.has(len(_DATA_END)):
            stated = int.from_bytes(window.bytes(RECORD.size, len(_DATA_END)), "little")
            if checksum not in (None, stated) and (stated or self._has_sections):
                self._report("the checksum of the data section")
            self.has_checksums |= stated != 0
        elif not self._has_sections:
            self._report(f"the end of the data section, byte {begin}")
        self._verify_summary(footer, begin + len(_DATA_END))

    def _verify_summary(self, footer: Footer, begin: int) -> None:
        """Report a summary whose checksum is wrong; ``begin`` is where the data section ends."""
        if not self._has_sections and (footer.summary_start == 0 or footer.summary_crc == 0):
            return
        first, end = footer.summary_start, self._size - len(MAGIC) - 4  # up to the checksum in the footer
        if end - first > _LONGEST_SUMMARY:
            self._report(f"the summary has {end - first:,} bytes, more than the {_LONGEST_SUMMARY:,} that are verified", is_refused=True)
            return
        checksum, at = 0, first
        while at < end:
            block = self._bytes(at, min(at + _BLOCK, end))
            checksum, at = zlib.crc32(block, checksum), at + len(block)
        if checksum != footer.summary_crc or (self._has_sections and first != begin):
            self._report(f"the summary, bytes {begin} to {self._size}")

    def _footer(self) -> Footer | None:
        """Return the record at the end of the file; None if it has no proper end."""
        tail = self._bytes(max(self._size - _FOOTER - len(MAGIC), 0), self._size)
        if len(tail) < _FOOTER + len(MAGIC) or not tail.endswith(MAGIC) or tail[: RECORD.size] != RECORD.pack(Opcode.FOOTER, _FOOTER - RECORD.size):
            return None
        footer = parsed(Opcode.FOOTER, tail[RECORD.size : -len(MAGIC)])
        return footer if footer.summary_start < self._size else None

    def _reason(self, position: int) -> str:
        """Return why reading ended at a byte."""
        if position >= self._size:
            return "it was not completed"
        if self._bytes(position, position + 1) == b"\0":
            return f"there is no record at byte {position}"
        return "it ends within a record"

    def _bytes(self, begin: int, end: int) -> bytes:
        self._stream.seek(begin)
        return self._stream.read(max(min(end, self._size) - begin, 0))


def _checksum_records_in(data: bytes) -> Iterator[tuple[int, int, int]]:
    """Yield (byte, first byte of its section in the file, checksum) of whatever begins as a checksum record and is whole."""
    for found in _HEAD.finditer(data, 0, max(len(data) - CHECKSUM_RECORD.size + len(CHECKSUM_HEAD), 0)):
        _, _, first, checksum = CHECKSUM_RECORD.unpack_from(data, found.start())
        yield found.start(), first, checksum


def records_in(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield opcode and content of the records of a section but the many small indexes, as far as they can be told apart."""
    at = 0
    while at + RECORD.size <= len(data):
        opcode, length = RECORD.unpack_from(data, at)
        begin, at = at + RECORD.size, at + RECORD.size + length
        if at > len(data) or not opcode:
            return
        if opcode != Opcode.MESSAGE_INDEX:
            yield opcode, data[begin:at]


class _Window:
    """The bytes of a file from a position on, read by blocks.

    Parameters
    ----------
    stream : the file; whoever else reads from it may move its position.
    position : of the first byte.
    size : length of the file [byte].
    """

    def __init__(self, stream: BinaryIO, position: int, size: int):
        self._stream, self._size, self.position = stream, size, position
        self._data, self._at = b"", 0

    def has(self, length: int) -> bool:
        """Whether the file has so many more bytes, which are read."""
        there = len(self._data) - self._at
        if there < length:
            self._stream.seek(self.position + there)
            self._data, self._at = self._data[self._at :] + self._stream.read(max(length - there, _BLOCK)), 0
        return len(self._data) - self._at >= length

    def head(self, at: int) -> tuple[int, int]:
        """Return opcode and length of the record at a byte, which `has` has read."""
        return RECORD.unpack_from(self._data, self._at + at)

    def bytes(self, begin: int, end: int) -> bytes:
        """Return bytes which `has` has read."""
        return self._data[self._at + begin : self._at + end]

    def find(self, wanted: bytes, begin: int, end: int) -> int | None:
        """Return where some bytes stand next, beginning between two bytes of the window; None if they do not."""
        for upto in range(begin + _BLOCK, end + _BLOCK, _BLOCK):
            is_more = self.has(min(upto, end))
            at = self._data.find(wanted, self._at + begin, self._at + end)
            if at >= 0 or not is_more:
                return at - self._at if at >= 0 else None
        return None

    def begins_with(self, head: bytes) -> bool:
        """Whether the next bytes are these."""
        return self.has(len(head)) and self.bytes(0, len(head)) == head

    def advance(self, length: int) -> None:
        """Move on by so many bytes, which `has` has read."""
        self._at, self.position = self._at + length, self.position + length

    def skip(self, length: int) -> None:
        """Move on by so many bytes without reading them."""
        self._data, self._at, self.position = b"", 0, self.position + length
