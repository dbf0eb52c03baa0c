# SPDX-License-Identifier: Apache-2.0
"""DICOM files in explicit little endian, as far as changing texts in them needs."""
import struct

LONG = {b"OB", b"OW", b"OF", b"OD", b"OL", b"OV", b"SQ", b"UT", b"UN", b"UC", b"UR", b"SV", b"UV"}
UNDEFINED = 0xFFFFFFFF


def read_elements(data, start=0, end=None):
    """[[(group, element), VR, value]]; the value of a sequence is a list of items, each such a list."""
    end = len(data) if end is None else end
    elements = []
    while start + 8 <= end:
        group, element = struct.unpack_from("<HH", data, start)
        if (group, element) == (0xFFFE, 0xE00D):
            return elements, start + 8
        vr = data[start + 4:start + 6]
        if vr in LONG:
            length, = struct.unpack_from("<I", data, start + 8)
            start += 12
        else:
            length, = struct.unpack_from("<H", data, start + 6)
            start += 8
        if vr == b"SQ":
            value, start = read_items(data, start, end if length == UNDEFINED else start + length)
        elif length == UNDEFINED:  # encapsulated pixels
            value, start = (data[start:end], "undefined"), end
        else:
            value = data[start:start + length]
            start += length
        elements.append([(group, element), vr, value])
    return elements, start


def read_items(data, start, end):
    items = []
    while start + 8 <= end:
        tag = struct.unpack_from("<HH", data, start)
        length, = struct.unpack_from("<I", data, start + 4)
        start += 8
        if tag == (0xFFFE, 0xE0DD):
            break
        item, start = read_elements(data, start, end if length == UNDEFINED else start + length)
        items.append(item)
    return items, start


def write_elements(elements):
    out = b""
    for (group, element), vr, value in sorted(elements, key=lambda entry: entry[0]):
        if vr == b"SQ":
            value = b"".join(
                struct.pack("<HHI", 0xFFFE, 0xE000, len(body)) + body
                for body in (write_elements(item) for item in value))
        length = len(value)
        if isinstance(value, tuple):
            value, length = value[0], UNDEFINED
        elif len(value) % 2:
            value += b"\0" if vr in (b"UI", b"OB", b"UN") else b" "
            length += 1
        head = struct.pack("<HH", group, element) + vr
        head += struct.pack("<HI", 0, length) if vr in LONG else struct.pack("<H", length)
        out += head + value
    return out


class DicomBytes:
    def __init__(self, data):
        self.preamble = data[:132]
        self.elements, _ = read_elements(data, 132)

    def bytes(self):
        meta = [entry for entry in self.elements if entry[0][0] == 2 and entry[0] != (2, 0)]
        rest = [entry for entry in self.elements if entry[0][0] != 2]
        body = write_elements(meta)
        length = write_elements([[(2, 0), b"UL", struct.pack("<I", len(body))]])
        return self.preamble + length + body + write_elements(rest)

    def get(self, tag):
        return next((entry[2] for entry in self.elements if entry[0] == tag), None)

    def set(self, tag, vr, value):
        value = value.encode() if isinstance(value, str) else value
        self.elements = [entry for entry in self.elements if entry[0] != tag]
        self.elements.append([tag, vr, value])
        return self

    def walk(self, elements=None):
        """Every element that is no sequence, those within sequences, too."""
        for entry in self.elements if elements is None else elements:
            if entry[1] == b"SQ":
                for item in entry[2]:
                    yield from self.walk(item)
            else:
                yield entry
