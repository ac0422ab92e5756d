"""What stands in a bag: topics, messages and images."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from mcap.records import Channel, Message, Schema

from geoprim_core._check import AnyArray
from geoprim_core.errors import BagError, InputError
from geoprim_core.io.image_message import image_from_message
from geoprim_core.io.record import stamp_of

IMAGE_TYPES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage")


@dataclass(frozen=True)
class Topic:
    """A topic of a bag: name, full message type, number of messages."""

    name: str
    type: str
    count: int


@dataclass(frozen=True)
class BagMessage:
    """A message of a bag.

    Attributes
    ----------
    topic, type : str
    log_time_ns : int
    raw : bytes
        CDR bytes as they stand in the bag.
    definition : str
        Schema text of the type; empty where the bag has none.
    doubt : str
        Why its bytes, its topic or its type may be wrong; empty when nothing speaks against them.
    encoding : str
        How the bytes are to be read, as the bag says.
    """

    topic: str
    type: str
    log_time_ns: int
    raw: bytes
    definition: str
    decoder: Callable[[], Any]
    doubt: str = ""
    encoding: str = "cdr"

    @cached_property
    def decoded(self) -> Any:
        """The message with its fields as attributes; damaged bytes raise `BagError`."""
        return self.decoder()


class BagRecord(NamedTuple):
    """A message of a bag with the records that describe it, and why it may be wrong."""

    channel: Channel
    schema: Schema | None
    message: Message
    doubt: str


@dataclass(frozen=True, eq=False)
class BagImage:
    """An image of a bag, or None and the reason why it cannot be used.

    Attributes
    ----------
    image : (H, W) or (H, W, 3) array in BGR order, or None
    reason : str
        Empty when there is an image.
    stamp_ns : int
        Stamp of the header; the log time where the header cannot be read.
    frame_id : str
    log_time_ns : int
    """

    image: AnyArray | None
    reason: str
    stamp_ns: int
    frame_id: str
    log_time_ns: int


def bag_image(message: BagMessage) -> BagImage:
    """Return the image of a message of a bag, or None in it and the reason."""
    stamp, frame = message.log_time_ns, ""
    try:
        decoded = message.decoded
        stamp, frame = stamp_of(decoded), str(decoded.header.frame_id)
        image = image_from_message(decoded)
    except (BagError, InputError) as error:
        return BagImage(None, str(error), stamp, frame, message.log_time_ns)
    return BagImage(image, "", stamp, frame, message.log_time_ns)
