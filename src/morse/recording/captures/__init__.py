"""Messages whose numbers are stored in the tick, and encoded later for many ticks at once.

A capture represents the messages of several components or robots in one tick. In the tick, the poses of all rigid
groups and the distances of scans are copied. The thread that writes the file encodes them with the kernel.
"""

from morse.recording.captures.capture import Capture
from morse.recording.captures.copies import CopiesCapture
from morse.recording.captures.frames import FramesCapture
from morse.recording.captures.groups import capture_of
from morse.recording.captures.layout import Layout
from morse.recording.captures.lone import Lone
from morse.recording.captures.moments import Moments
from morse.recording.captures.nodes import NodesCapture

__all__ = ["Capture", "CopiesCapture", "FramesCapture", "Layout", "Lone", "Moments", "NodesCapture", "capture_of"]
