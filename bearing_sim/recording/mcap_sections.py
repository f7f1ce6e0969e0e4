# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Take an MCAP file apart into sections, and verify whatever checksums it has.

A file of this version has a checksum record after each section (see `bearing_sim.recording.mcap_format`): any flipped bit of it is found, also in
an unfinished file, and what follows a damaged section is found again by the next checksum record.  In other files each record is a section of its
own, which nothing covers but the checksum of the whole data section, if the writer made one.
"""

import re
import zlib
from collections.abc import Callable, Container, Iterator
from typing import BinaryIO, NamedTuple

from mcap.opcode import Opcode
from mcap.records import DataEnd, Footer

from bearing_sim.files.limits import RECORDING_RECORD
from bearing_sim.recording.mcap_format import (
    CHECKSUM_HEAD,
    CHECKSUM_RECORD,
    MAGIC,
    RECORD,
    packed,
    parsed,
)

_BLOCK = 1024 * 1024  # [byte] read at once
_FIRST_SEARCHED = 8 * 1024  # [byte] in which a checksum record is looked for first; then twice as many, and so on
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


class SectionReader:
    """Yields the sections of the data section of a file, and verifies its end.

    Parameters
    ----------
    stream : the file, which begins with the magic number.
    size : its length [byte].
    report : called with a text that names something damaged, before its section is yielded, or, with ``is_refused``, says why something is not read.
    unneeded : opcodes of records that need no report if they are longer than the limit.

    Attributes
    ----------
    read : how far the file was read [byte].
    has_checksums : whether checksums cover all of it: those of sections or, after reading, that of the data section.
    is_finished : after reading: whether the file has its proper end.
    ends : why reading ended before that, or ``""``.
    """

    def __init__(self, stream: BinaryIO, size: int, report: Callable[..., None], unneeded: Container[int] = ()):
        self._stream, self._size, self._report, self._unneeded = stream, size, report, unneeded
        self._longest = RECORDING_RECORD.value
        self._block = 0, b""  # what was read last: its first byte in the file, and the bytes
        self._searched, self._left = 0, 4 * size + _BLOCK  # [byte] that searches may still look at; an honest file needs twice its size
        self.read, self.is_finished, self.ends = 0, False, ""
        # Whether there is a checksum record near the beginning; not only the first one, because that may be damaged.
        self.has_checksums = self._has_sections = any(first < at for at, first, _ in self._checksum_records(0, _BLOCK))

    def __iter__(self) -> Iterator[Section]:
        return self._sections() if self._has_sections else self._single_records()

    def _single_records(self) -> Iterator[Section]:
        at = len(MAGIC)
        checksum: int | None = zlib.crc32(MAGIC)  # of the file so far; None once something was not read
        while True:
            opcode, whole = self._head(at)
            if not whole or at + whole > self._size:
                break
            if whole - RECORD.size > self._longest:
                if opcode not in self._unneeded:
                    self._report(f"a record at byte {at} has {RECORDING_RECORD.refusal(whole - RECORD.size)}", is_refused=True)
                data, checksum = b"", None
            elif not opcode:
                break
            elif opcode in (Opcode.DATA_END, Opcode.FOOTER):
                self._finish(at, checksum)
                return
            else:
                data = self._bytes(at, at + whole)
                checksum = None if checksum is None else zlib.crc32(data, checksum)
            self.read = at = at + whole
            yield Section(data, True)
        self.read, self.ends = at, self._reason(at)

    def _sections(self) -> Iterator[Section]:
        at = 0
        checksum: int | None = 0  # of the file so far; None once anything is damaged
        while at < self._size and not self._begins_data_end(at):
            begin, (end, expected, at) = at, self._next_section(at)
            if begin == end == at:
                self._report(f"the end of the data section, byte {begin}")
                break
            self.read = at
            if expected is None and at == self._size:
                self.ends = self._reason(begin)
                data = self._bytes(begin, min(end, begin + _LONGEST_SALVAGED))  # its writer was stopped there, which is no damage
                yield Section(data[len(MAGIC) :] if begin == 0 else data, False)
                return
            if end - begin > self._longest + 2 * _LONGEST_INDEX:
                self._report(f"bytes {begin} to {end} have {RECORDING_RECORD.refusal(end - begin)}", is_refused=True)
                checksum = None
                yield Section(b"", False)
                continue
            section = self._verified(begin, data := self._bytes(begin, end), expected)
            checksum = None if checksum is None or not section.is_sound else zlib.crc32(self._bytes(end, at), zlib.crc32(data, checksum))
            yield section
        if at < self._size:
            self._finish(at, checksum)
        else:
            self.ends = self._reason(at)

    def _head(self, at: int) -> tuple[int, int]:
        """Return opcode and length, with its head, of the record at a byte of the file, which may be longer than that; zeros if there is none."""
        head = self._bytes(at, at + RECORD.size)
        opcode, length = RECORD.unpack(head) if len(head) == RECORD.size else (0, -RECORD.size)
        return opcode, RECORD.size + length

    def _begins_data_end(self, at: int) -> bool:
        return self._bytes(at, at + RECORD.size) == _DATA_END[: RECORD.size]

    def _next_section(self, begin: int) -> tuple[int, int | None, int]:
        """Find the end of a section.

        Its checksum record usually stands soon after the first record.  The records between are small and many, and need not be told apart: the
        first byte of the section, which the checksum record repeats, is a mark that is found nowhere else.  Otherwise it is searched.

        Returns
        -------
        end : of its records in the file.
        checksum : that its checksum record states; None if that was not found, and may be the last of the records.
        after : where the next section begins; the length of the file if there is none.
        """
        first = begin or len(MAGIC)
        opcode, whole = self._head(first)
        if opcode and whole - RECORD.size <= self._longest and first + whole <= self._size:
            first += whole
        for at, own, checksum in self._checksum_records(first, first + _LONGEST_INDEX):
            if own == begin:
                return at, checksum, at + CHECKSUM_RECORD.size
        self._searched += 1
        for at, first, checksum in self._checksum_records(begin, begin + _LONGEST_SEARCH) if self._searched <= _MOST_SEARCHED else ():
            if first == begin:
                return at, checksum, at + CHECKSUM_RECORD.size
            if not begin < first <= at:
                continue
            self._left -= at - first
            if self._left > 0 and zlib.crc32(self._bytes(first, at)) == checksum:
                return first, None, first
        footer = footer_of(self._bytes, self._size)
        end = -1 if footer is None else footer.summary_start - len(_DATA_END)
        return (end, None, end) if begin <= end < self._size else (self._size, None, self._size)

    def _checksum_records(self, begin: int, end: int) -> Iterator[tuple[int, int, int]]:
        """Yield (byte of the file, first byte of its section, checksum) of whatever begins as a checksum record from a byte on to about another."""
        length = _FIRST_SEARCHED
        while begin < end and len(data := self._bytes(begin, begin + length)) >= CHECKSUM_RECORD.size:
            for found in _HEAD.finditer(data, 0, len(data) - CHECKSUM_RECORD.size + len(CHECKSUM_HEAD)):
                _, _, first, checksum = CHECKSUM_RECORD.unpack_from(data, found.start())
                yield begin + found.start(), first, checksum
            begin, length = begin + len(data) - CHECKSUM_RECORD.size + 1, min(2 * length, _BLOCK)

    def _verified(self, begin: int, data: bytes, checksum: int | None) -> Section:
        """Return a section; ``checksum`` as of `_next_section`."""
        records = data[len(MAGIC) :] if begin == 0 else data
        is_sound = checksum is not None and zlib.crc32(data) == checksum
        if not is_sound:
            kind = _KINDS.get(records[0], "a record") if records else "a record"
            self._report(f"{kind}, bytes {begin} to {begin + len(data)}")
        return Section(records, is_sound)

    def _finish(self, begin: int, checksum: int | None) -> None:
        """Verify what follows the data section.

        Parameters
        ----------
        begin : the end of the data section [byte].
        checksum : of the file up to there; None if it is known to be damaged.
        """
        self.read, footer = self._size, footer_of(self._bytes, self._size)
        if footer is None:
            self.ends = "it is cut short, or its last bytes are not the end of an MCAP file"
            return
        self.is_finished, after = True, begin + len(_DATA_END)
        if self._begins_data_end(begin) and after <= self._size:
            stated = int.from_bytes(self._bytes(begin + RECORD.size, after), "little")
            if checksum not in (None, stated) and (stated or self._has_sections):
                self._report("the checksum of the data section")
            self.has_checksums |= stated != 0
        elif not self._has_sections:
            self._report(f"the end of the data section, byte {begin}")
        self._verify_summary(footer, after)

    def _verify_summary(self, footer: Footer, begin: int) -> None:
        """Report a summary whose checksum is wrong; ``begin`` is where the data section ends."""
        if not self._has_sections and (footer.summary_start == 0 or footer.summary_crc == 0):
            return
        first, end = footer.summary_start, self._size - len(MAGIC) - 4  # up to the checksum in the footer
        if end - first > _LONGEST_SUMMARY:
            self._report(f"the summary has {end - first:,} bytes, more than the {_LONGEST_SUMMARY:,} that are verified", is_refused=True)
            return
        checksum = 0
        for at in range(first, end, _BLOCK):
            checksum = zlib.crc32(self._bytes(at, min(at + _BLOCK, end)), checksum)
        if checksum != footer.summary_crc or (self._has_sections and first != begin):
            self._report(f"the summary, bytes {begin} to {self._size}")

    def _reason(self, position: int) -> str:
        """Return why reading ended at a byte."""
        if position >= self._size:
            return "it was not completed"
        if self._bytes(position, position + 1) == b"\0":
            return f"there is no record at byte {position}"
        return "it ends within a record"

    def _bytes(self, begin: int, end: int) -> bytes:
        """Return the bytes of the file between two of them, as many as there are; it is read by blocks."""
        end = min(end, self._size)
        first, data = self._block
        if not first <= begin <= end <= first + len(data):
            self._stream.seek(begin)
            first, data = self._block = begin, self._stream.read(max(end - begin, _BLOCK))
        return data[begin - first : max(end, begin) - first]


def footer_of(read: Callable[[int, int], bytes], size: int) -> Footer | None:
    """Return the record at the end of a file of a size [byte]; None if it has no proper end.  ``read`` returns the bytes between two of them."""
    tail = read(max(size - _FOOTER - len(MAGIC), 0), size)
    if len(tail) < _FOOTER + len(MAGIC) or not tail.endswith(MAGIC) or tail[: RECORD.size] != RECORD.pack(Opcode.FOOTER, _FOOTER - RECORD.size):
        return None
    footer = parsed(Opcode.FOOTER, tail[RECORD.size : -len(MAGIC)])
    return footer if footer.summary_start < size else None


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
