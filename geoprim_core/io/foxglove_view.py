"""A view for Foxglove: frames with their ellipses, served live or written into a file.

Needs the optional package foxglove-sdk, which is imported when a view is made.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self

import cv2
import numpy as np

from geoprim_core._check import AnyArray
from geoprim_core.errors import FileError, GeoprimError, InputError, MissingPackageError
from geoprim_core.io.annotations import (
    Line,
    Text,
    contour_lines,
    ellipse_lines,
    ellipse_texts,
    polygon_lines,
)
from geoprim_core.io.drawing import displayed, overlay_scale
from geoprim_core.io.shown import OverlayParams, Shown
from geoprim_core.types import Contours, Polygons

IMAGE_FORMATS = ("jpeg", "png", "raw")

IMAGE, ANNOTATIONS, CONTOURS, POLYGONS = "/image", "/annotations", "/contours", "/polygons"
ELLIPSES, DIAGNOSTICS = "/ellipses", "/diagnostics"

_JPEG_QUALITY = 90
_BACKLOG = 32  # frames that wait for a slow viewer; the oldest give way
_NUMBERS = ("x", "y", "semi_major", "semi_minor", "angle", "score")
_DECIMALS = 4
_ELLIPSE = {
    "type": "object",
    "properties": {
        "id": {"type": "integer"},
        "label": {"type": "string"},
        **{name: {"type": "number"} for name in _NUMBERS},
    },
}
_ELLIPSES_SCHEMA = {
    "title": "geoprim.Ellipses",
    "type": "object",
    "properties": {
        "count": {"type": "integer"},
        "mean_score": {"type": "number"},
        "milliseconds": {"type": "number"},
        "complete": {"type": "boolean"},
        "reason": {"type": "string"},
        "ellipses": {"type": "array", "items": _ELLIPSE},
    },
}
_TIME = {"type": "object", "properties": {n: {"type": "integer"} for n in ("sec", "nsec")}}
_TEXTS = {"type": "object", "properties": {n: {"type": "string"} for n in ("key", "value")}}
_STATUS = {
    "type": "object",
    "properties": {
        "level": {"type": "integer"},
        **{n: {"type": "string"} for n in ("name", "message", "hardware_id")},
        "values": {"type": "array", "items": _TEXTS},
    },
}
_HEADER = {"type": "object", "properties": {"stamp": _TIME, "frame_id": {"type": "string"}}}
# Foxglove's diagnostics panels know the type by this name, in whatever encoding.
_DIAGNOSTICS_SCHEMA = {
    "title": "diagnostic_msgs/DiagnosticArray",
    "type": "object",
    "properties": {"header": _HEADER, "status": {"type": "array", "items": _STATUS}},
}


@dataclass(frozen=True, eq=False)
class ViewFrame:
    """A frame to look at.

    Attributes
    ----------
    image : (H, W), (H, W, 3) or (H, W, 4) array
    shown : Shown
    stamp_ns : int
    frame_id : str
    contours, polygons : Contours, Polygons or None
    seconds : float
        Time of detection; NaN where it was not measured.
    reason : str
        Why the result is not complete; empty where it is.
    """

    image: AnyArray
    shown: Shown
    stamp_ns: int
    frame_id: str = ""
    contours: Contours | None = None
    polygons: Polygons | None = None
    seconds: float = float("nan")
    reason: str = ""


class View:
    """The channels that a frame is shown on, for Foxglove's panels; a context manager.

    Topics: `/image`, `/annotations` with the ellipses, `/contours` and `/polygons` likewise,
    `/ellipses` as numbers and `/diagnostics`. Only what somebody looks at is made.

    Parameters
    ----------
    image_format : {"jpeg", "png", "raw"}
    style : OverlayParams, optional
        Colours and texts of the annotations; may be replaced at any time.

    Raises
    ------
    MissingPackageError
        foxglove-sdk is not installed.
    InputError
        The image format is not known.
    """

    def __init__(self, image_format: str = "jpeg", style: OverlayParams | None = None) -> None:
        if image_format not in IMAGE_FORMATS:
            raise InputError("image_format", f"one of {', '.join(IMAGE_FORMATS)}", image_format)
        self._sdk = sdk = foxglove_sdk()
        self.style = style or OverlayParams()
        self._format = image_format
        self._context = context = sdk.Context()
        kinds = sdk.channels
        raw = image_format == "raw"
        self.channels: dict[str, Any] = {
            IMAGE: (kinds.RawImageChannel if raw else kinds.CompressedImageChannel)(
                IMAGE, context=context
            ),
            **{
                topic: kinds.ImageAnnotationsChannel(topic, context=context)
                for topic in (ANNOTATIONS, CONTOURS, POLYGONS)
            },
            ELLIPSES: sdk.Channel(ELLIPSES, schema=_ELLIPSES_SCHEMA, context=context),
            DIAGNOSTICS: sdk.Channel(DIAGNOSTICS, schema=_DIAGNOSTICS_SCHEMA, context=context),
        }
        self._sink: Any = None

    def serve(self, host: str = "127.0.0.1", port: int = 8765) -> int:
        """Start the server; return its port, which the system chooses where 0 is given.

        Raises
        ------
        GeoprimError
            The server cannot be started there.
        """
        try:
            self._sink = self._sdk.start_server(
                name="geoprim", host=host, port=port, context=self._context,
                message_backlog_size=_BACKLOG,
            )  # fmt: skip
        except Exception as error:  # the package has no class of its own for it
            raise GeoprimError(f"cannot serve at {host}:{port}: {error}") from None
        return int(self._sink.port)

    def write_to(self, path: str | os.PathLike[str]) -> None:
        """Write an MCAP file for Foxglove instead of serving; an old one is replaced.

        Raises
        ------
        FileError
            The file cannot be written.
        """
        try:
            self._sink = self._sdk.open_mcap(path, allow_overwrite=True, context=self._context)
        except Exception as error:
            raise FileError(f"cannot write {path}: {error}") from None

    def watched(self) -> bool:
        """Tell whether somebody looks at a topic."""
        return any(channel.has_sinks() for channel in self.channels.values())

    def show(self, frame: ViewFrame, log_time_ns: int | None = None) -> None:
        """Send a frame.

        Parameters
        ----------
        frame : ViewFrame
        log_time_ns : int, optional
            Where the frame stands in time for a file; by default now.
        """
        stamp = frame.stamp_ns
        self._log(IMAGE, lambda: self._image(frame), log_time_ns)
        scale = overlay_scale(frame.image.shape)
        self._log(ANNOTATIONS, lambda: self._ellipses(frame.shown, stamp, scale), log_time_ns)
        self._log(ELLIPSES, lambda: as_numbers(frame), log_time_ns)
        if frame.contours is not None:
            self.show_contours(frame.contours, stamp, log_time_ns)
            if frame.polygons is not None:
                self.show_polygons(frame.polygons, frame.contours, stamp, log_time_ns)

    def show_contours(
        self, contours: Contours, stamp_ns: int, log_time_ns: int | None = None
    ) -> None:
        """Send the contours of a frame."""
        self._log(
            CONTOURS, lambda: self._annotations(contour_lines(contours), (), stamp_ns), log_time_ns
        )

    def show_polygons(
        self, polygons: Polygons, contours: Contours, stamp_ns: int, log_time_ns: int | None = None
    ) -> None:
        """Send the polygons of a frame."""
        lines = polygon_lines
        self._log(
            POLYGONS,
            lambda: self._annotations(lines(polygons, contours), (), stamp_ns),
            log_time_ns,
        )

    def diagnose(
        self, statuses: Iterable[Mapping[str, Any]], stamp_ns: int, log_time_ns: int | None = None
    ) -> None:
        """Send diagnostics: each status with level, name, message, hardware_id and values."""
        stamp = dict(zip(("sec", "nsec"), divmod(stamp_ns, 1_000_000_000), strict=True))
        head = {"stamp": stamp, "frame_id": ""}
        self._log(DIAGNOSTICS, lambda: {"header": head, "status": list(statuses)}, log_time_ns)

    def close(self) -> None:
        """End the server or the file."""
        sink, self._sink = self._sink, None
        if sink is not None:
            with suppress(Exception):  # whatever is left of a connection
                (sink.stop if hasattr(sink, "stop") else sink.close)()

    def __enter__(self) -> Self:
        """Return the view itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End the server or the file."""
        self.close()

    def _log(self, topic: str, make: Any, log_time_ns: int | None) -> None:
        channel = self.channels[topic]
        if channel.has_sinks():
            channel.log(make(), log_time=log_time_ns)

    def _image(self, frame: ViewFrame) -> Any:
        messages, image = self._sdk.messages, displayed(frame.image)
        head = {"timestamp": self._stamp(frame.stamp_ns), "frame_id": frame.frame_id}
        if self._format == "raw":
            height, width = image.shape[:2]
            return messages.RawImage(
                **head, width=width, height=height, encoding="bgr8", step=3 * width,
                data=image.tobytes(),
            )  # fmt: skip
        quality = [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY] if self._format == "jpeg" else []
        _, data = cv2.imencode(f".{self._format}", image, quality)
        return messages.CompressedImage(**head, data=data.tobytes(), format=self._format)

    def _ellipses(self, shown: Shown, stamp_ns: int, scale: float) -> Any:
        lines = ellipse_lines(shown, self.style, scale)
        return self._annotations(lines, ellipse_texts(shown, self.style, scale), stamp_ns)

    def _annotations(self, lines: Sequence[Line], texts: Sequence[Text], stamp_ns: int) -> Any:
        messages, stamp = self._sdk.messages, self._stamp(stamp_ns)
        kinds = messages.PointsAnnotationType
        points = [
            messages.PointsAnnotation(
                timestamp=stamp,
                type=kinds.LineLoop if line.closed else kinds.LineStrip,
                points=[messages.Point2(x=x, y=y) for x, y in line.points.tolist()],
                outline_color=self._colour(line.colour),
                thickness=line.thickness,
            )
            for line in lines
        ]
        words = [
            messages.TextAnnotation(
                timestamp=stamp,
                position=messages.Point2(x=text.at[0], y=text.at[1]),
                text=text.text,
                font_size=text.size,
                text_color=self._colour(text.colour),
                background_color=messages.Color(r=0.0, g=0.0, b=0.0, a=0.6),
            )
            for text in texts
        ]
        return messages.ImageAnnotations(timestamp=stamp, points=points, texts=words)

    def _colour(self, rgb: tuple[float, float, float]) -> Any:
        return self._sdk.messages.Color(r=rgb[0], g=rgb[1], b=rgb[2], a=1.0)

    def _stamp(self, stamp_ns: int) -> Any:
        sec, nsec = divmod(max(stamp_ns, 0), 1_000_000_000)
        return self._sdk.messages.Timestamp(sec, nsec)


def as_numbers(frame: ViewFrame) -> dict[str, Any]:
    """Return the ellipses of a frame as plain data, rounded: what tables and plots show."""
    shown = frame.shown
    numbers = np.column_stack([shown.ellipses.array(), shown.score]).round(_DECIMALS)
    rows = [
        {"id": i, "label": label, **dict(zip(_NUMBERS, row, strict=True))}
        for i, label, row in zip(shown.ids, shown.labels, numbers.tolist(), strict=True)
    ]
    return {
        "count": len(shown),
        "mean_score": float(shown.score.mean()) if len(shown) else 0.0,
        "milliseconds": 1e3 * frame.seconds if frame.seconds == frame.seconds else 0.0,
        "complete": not frame.reason,
        "reason": frame.reason,
        "ellipses": rows,
    }


def foxglove_sdk() -> Any:
    """Return the package foxglove, which foxglove-sdk installs.

    Raises
    ------
    MissingPackageError
        It is not installed; the text says what installs it.
    """
    try:
        import foxglove
        import foxglove.channels
        import foxglove.messages
    except ImportError as error:
        text = "the view needs the package foxglove-sdk: python -m pip install foxglove-sdk"
        raise MissingPackageError(f"{text} ({error})") from None
    return foxglove
