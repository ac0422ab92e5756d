"""Quality of service: the profiles, their overrides by parameter, mismatches in one sentence."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.exceptions import InvalidParameterTypeException, ParameterAlreadyDeclaredException
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

from geoprim_core.errors import ParameterError
from geoprim_core.params import Option

_DEPTH = Option("depth", 1, "history depth", low=0, high=2**31 - 1)
_FOREVER_NS = 2**62
# Policy -> the names that a parameter may give it.
_POLICIES: dict[str, dict[str, Any]] = {
    "history": {p.name.lower(): p for p in (HistoryPolicy.KEEP_LAST, HistoryPolicy.KEEP_ALL)},
    "reliability": {
        p.name.lower(): p for p in (ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT)
    },
    "durability": {
        p.name.lower(): p for p in (DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL)
    },
}


def sensor_qos(depth: int = 1) -> QoSProfile:
    """Return the profile for images that come in: best effort, only the newest."""
    return QoSProfile(
        depth=depth,
        history=HistoryPolicy.KEEP_LAST,
        reliability=ReliabilityPolicy.BEST_EFFORT,
    )


def result_qos(depth: int = 10) -> QoSProfile:
    """Return the profile for results: reliable, the last ten.

    Stages read each other with it. With a depth of 1, stages in one executor overwrite what the
    next one has not taken yet: half of the frames were lost between them on a busy machine. The
    images, read with depth 1, are where a chain drops.
    """
    return QoSProfile(
        depth=depth, history=HistoryPolicy.KEEP_LAST, reliability=ReliabilityPolicy.RELIABLE
    )


def overridden(node: Node, topic: str, end: str, qos: QoSProfile) -> QoSProfile:
    """Return a profile with what the parameters `qos_overrides.TOPIC.END.POLICY` say.

    They are declared here, with the profile as their default. rclpy would declare them with the
    subscription; a lazy one may come much later, and a wrong value shall be told at the start.

    Parameters
    ----------
    node : the node that gets the parameters
    topic : resolved name
    end : "subscription" or "publisher"
    qos : the profile without overrides

    Raises
    ------
    ParameterError
        A value is not one of the policy.
    """
    start = f"qos_overrides.{topic}.{end}."
    depth = _DEPTH.checked(_declared(node, f"{start}depth", qos.depth))
    chosen: dict[str, Any] = {"depth": depth}
    for policy, names in _POLICIES.items():
        value = _declared(node, start + policy, getattr(qos, policy).name.lower())
        if value not in names:
            raise ParameterError(start + policy, f"one of {', '.join(names)}", repr(value))
        chosen[policy] = names[value]
    return QoSProfile(**chosen)


def _declared(node: Node, name: str, default: Any) -> Any:
    text = f"{name.rpartition('.')[2]} of the {name.split('.')[-2]}, read when the node starts"
    descriptor = ParameterDescriptor(description=text, read_only=True)
    try:
        return node.declare_parameter(name, default, descriptor).value
    except ParameterAlreadyDeclaredException:
        return node.get_parameter(name).value
    except InvalidParameterTypeException as error:
        kind = "a whole number" if isinstance(default, int) else "a text"
        raise ParameterError(name, kind, str(error)) from None


def mismatches(offered: QoSProfile, requested: QoSProfile) -> list[tuple[str, str, str]]:
    """Return policy, offered and requested value of every policy that keeps two ends apart.

    Examples
    --------
    >>> mismatches(sensor_qos(), result_qos())
    [('reliability', 'best_effort', 'reliable')]
    >>> mismatches(result_qos(), sensor_qos())
    []
    """
    pairs = (
        ("reliability", ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE),
        ("durability", DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL),
        ("liveliness", LivelinessPolicy.AUTOMATIC, LivelinessPolicy.MANUAL_BY_TOPIC),
    )
    found = [
        (policy, weak.name.lower(), strong.name.lower())
        for policy, weak, strong in pairs
        if getattr(offered, policy) == weak and getattr(requested, policy) == strong
    ]
    for policy in ("deadline", "liveliness_lease_duration"):
        ends = [getattr(qos, policy).nanoseconds for qos in (offered, requested)]
        long, short = (t if 0 < t < _FOREVER_NS else float("inf") for t in ends)  # 0: not set
        if long > short:
            said = "none" if long == float("inf") else f"{long * 1e-9:g} s"
            found.append((policy, said, f"{short * 1e-9:g} s"))
    return found


class QosReports:
    """Tells which peer of a topic does not match, why, and what to do; once a peer and topic."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._told: set[tuple[str, ...]] = set()

    def of_subscription(self, topic: str, qos: QoSProfile) -> SubscriptionEventCallbacks:
        """Return the event callbacks of a subscription to a resolved topic."""
        return SubscriptionEventCallbacks(
            incompatible_qos=lambda _: self._tell(topic, qos, "subscription")
        )

    def of_publisher(
        self, topic: str, qos: QoSProfile, matched: Callable[[Any], None]
    ) -> PublisherEventCallbacks:
        """Return the event callbacks of a publisher; `matched` is called where readers change."""
        return PublisherEventCallbacks(
            incompatible_qos=lambda _: self._tell(topic, qos, "publisher"), matched=matched
        )

    def _tell(self, topic: str, qos: QoSProfile, end: str) -> None:
        node, reading = self._node, end == "subscription"
        ask = node.get_publishers_info_by_topic if reading else node.get_subscriptions_info_by_topic
        for peer in ask(topic):
            name = f"{peer.node_namespace.rstrip('/')}/{peer.node_name}"
            ends = (peer.qos_profile, qos) if reading else (qos, peer.qos_profile)
            found = mismatches(*ends)
            if found and (topic, end, name) not in self._told:
                self._told.add((topic, end, name))
                node.get_logger().warning(sentence(topic, end, name, found))


def sentence(topic: str, end: str, peer: str, found: list[tuple[str, str, str]]) -> str:
    """Say which messages do not flow, why, and the remedy on either side.

    Examples
    --------
    >>> found = mismatches(sensor_qos(), result_qos())
    >>> print(sentence("/contours", "subscription", "/camera", found))
    nothing comes from /camera on /contours: what it offers does not fit what this node asks for: \
reliability best_effort against reliable; start this node with \
-p qos_overrides./contours.subscription.reliability:=best_effort or let /camera offer reliable
    """
    reading = end == "subscription"
    verb, answer = ("offer", "ask for") if reading else ("ask for", "offer")
    whys, own, theirs = [], [], []
    for policy, offered, requested in found:
        said, wished = (offered, requested) if reading else (requested, offered)
        whys.append(f"{policy} {said} against {wished}")
        theirs.append(wished)
        if policy in _POLICIES:
            own.append(f"-p qos_overrides.{topic}.{end}.{policy}:={said}")
    flow = f"comes from {peer}" if reading else f"goes to {peer}"
    why = f"what it {_third(verb)} does not fit what this node {_third(answer)}"
    remedies = [f"start this node with {' '.join(own)}"] if len(own) == len(found) else []
    remedies.append(f"let {peer} {verb} {' and '.join(theirs)}")
    return f"nothing {flow} on {topic}: {why}: {', '.join(whys)}; {' or '.join(remedies)}"


def _third(verb: str) -> str:
    word, _, rest = verb.partition(" ")
    return f"{word}s {rest}".strip()
