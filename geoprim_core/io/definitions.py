"""The message definitions: texts of geoprim_msgs, the types of ROS 2 Jazzy, CDR in and out."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from geoprim_core.errors import FileError, InputError
from geoprim_core.io.record import Record

_RULE = "=" * 80 + "\n"
_HERE = Path(__file__).resolve()
# Beside this file in an installed package, in the interface package of a source tree.
_FOLDERS = (_HERE.parent / "msg", _HERE.parents[2] / "msg_defs" / "geoprim_msgs" / "msg")


@cache
def message_texts() -> Mapping[str, str]:
    """Return full type name -> text of every message of geoprim_msgs.

    Raises
    ------
    FileError
        The definitions are neither installed nor in a source tree.

    Examples
    --------
    >>> "float32[] points" in message_texts()["geoprim_msgs/msg/Contours"]
    True
    """
    for folder in _FOLDERS:
        files = sorted(folder.glob("*.msg"))
        if files:
            return {f"geoprim_msgs/msg/{f.stem}": f.read_text(encoding="utf-8") for f in files}
    places = " and ".join(str(folder) for folder in _FOLDERS)
    raise FileError(f"the message definitions of geoprim_msgs are missing: no *.msg in {places}")


@cache
def typestore() -> Typestore:
    """Return the types of ROS 2 Jazzy and geoprim_msgs; shared, not to be changed."""
    return new_typestore(message_texts())


def new_typestore(texts: Mapping[str, str]) -> Typestore:
    """Return the types of ROS 2 Jazzy and of some definitions, full type name -> text."""
    store = get_typestore(Stores.ROS2_JAZZY)
    types: dict[str, Any] = {}
    for name, text in texts.items():
        types.update(get_types_from_msg(text, name))
    store.register({name: types[name] for name in types if name not in store.fielddefs})
    return store


@cache
def schema_text(type_name: str) -> str:
    """Return the definition of a type followed by those of all types in it, as bags keep it.

    Raises
    ------
    InputError
        The type is neither one of ROS 2 Jazzy nor of geoprim_msgs.

    Examples
    --------
    >>> "MSG: std_msgs/Header" in schema_text("geoprim_msgs/msg/Contours")
    True
    """
    store = _known(type_name)
    main, *parts = store.generate_msgdef(type_name, ros_version=2)[0].split(_RULE)
    texts = message_texts()
    sections = [texts.get(type_name, main)]
    for part in parts:
        title, _, body = part.partition("\n")
        package, _, name = title.removeprefix("MSG: ").partition("/")
        sections.append(f"{title}\n{texts.get(f'{package}/msg/{name}', body)}")
    return _RULE.join(section.rstrip("\n") + "\n" for section in sections)


def field_names(type_name: str, text: str) -> list[str]:
    """Return the names of the fields of one definition, in order, without constants.

    Examples
    --------
    >>> field_names("std_msgs/msg/ColorRGBA", "float32 r 1.0")
    ['r']
    """
    _, fields = get_types_from_msg(text, type_name)[type_name]
    return [name for name, _ in fields]


def split_schema(type_name: str, text: str) -> dict[str, str]:
    """Return full type name -> text of the parts of a schema text."""
    main, *parts = text.replace("\r\n", "\n").split(_RULE)
    texts = {type_name: main}
    for part in parts:
        title, _, body = part.partition("\n")
        package, _, name = title.removeprefix("MSG: ").strip().rpartition("/")
        texts[f"{package.removesuffix('/msg')}/msg/{name}"] = body
    return texts


def same_fields(type_name: str, text: str) -> bool:
    """Return whether a schema text defines a type of ROS 2 Jazzy as ROS 2 Jazzy does.

    Examples
    --------
    >>> same_fields("std_msgs/msg/String", "string data"), same_fields("std_msgs/msg/Char", "?")
    (True, False)
    """
    known = _jazzy().fielddefs.get(type_name)
    if known is None:
        return True  # a type that ROS 2 does not have cannot differ from it
    try:
        return bool(
            get_types_from_msg(split_schema(type_name, text)[type_name], type_name)[type_name]
            == known
        )
    except Exception:  # whatever the parser makes of a damaged text
        return False


@cache
def _jazzy() -> Typestore:
    return new_typestore({})


def type_hash(type_name: str) -> str:
    """Return the RIHS01 hash of a type, by which ROS 2 tells definitions apart."""
    return str(_known(type_name).hash_rihs01(type_name))


def serialize(record: Record) -> bytes:
    """Return the CDR bytes (little endian, with encapsulation header) of a record.

    Raises
    ------
    InputError
        The type is not known, or its fields are not those of the record.
    """
    message = _built(record, _known(record.type))
    return bytes(typestore().serialize_cdr(message, record.type))


def _known(type_name: str) -> Typestore:
    store = typestore()
    if type_name not in store.fielddefs:
        expected = "a message type of ROS 2 Jazzy or geoprim_msgs"
        raise InputError("type", expected, repr(type_name))
    return store


def _built(record: Record, store: Typestore) -> Any:
    fields = dict(record.fields)
    for name, value in record.fields.items():
        if isinstance(value, Record):
            fields[name] = _built(value, store)
        elif isinstance(value, list):
            fields[name] = [_built(v, store) if isinstance(v, Record) else v for v in value]
    try:
        return store.types[record.type](**fields)
    except (TypeError, KeyError) as error:
        raise InputError("record", f"the fields of {record.type}", str(error)) from None
