"""Commands on the selected fragment: another unit, pin, ban; each is one change that can be undone."""

from __future__ import annotations

from corpus_tools.core import Audio
from workbench.state import Options, Session, options_of, pin_at, with_pin, without_pin

__all__ = ["ban_unit", "heard", "is_tried", "options_shown", "swap_to", "swap_unit", "toggle_pin", "unban"]

_AROUND_S = 0.05


def options_shown(session: Session) -> Options | None:
    """Return what could speak the selected place; None without a result."""
    if session.options is not None:
        return session.options
    result = session.result
    if result is None or session.selected >= len(result.selection.chosen):
        return None
    return options_of(result, session.selected)


def swap_to(session: Session, at: int) -> bool:
    """Let another option speak the selected place; False when there is no such option."""
    options = options_shown(session)
    if options is None or not 0 <= at < len(options.options):
        return False
    moved = options.moved(at - options.at)
    before = options.options[options.at]
    pins = without_pin(session.pins, before.first, before.last)
    session.param.update(options=moved, pins=with_pin(pins, moved.options[moved.at]))
    return True


def swap_unit(session: Session, step: int) -> bool:
    """Let the next (or the previous) option speak the selected place, round and round."""
    options = options_shown(session)
    if options is None or len(options.options) < 2:
        return False
    return swap_to(session, (options.at + step) % len(options.options))


def is_tried(session: Session) -> bool:
    """Whether the selected place is pinned by a swap that nobody has kept yet."""
    options = session.options
    return options is not None and options.tried and options.options[options.at].pin in session.pins


def toggle_pin(session: Session) -> bool:
    """Pin the selected fragment, so that the search must use it there; or let it go again.

    One that a swap has pinned is only kept: it stays pinned until this is called once more.
    """
    result = session.result
    if result is None or session.selected >= len(result.selection.chosen):
        return False
    chosen = result.selection.chosen[session.selected]
    if is_tried(session):
        assert session.options is not None
        session.options = session.options.kept()
    elif pin_at(session.pins, chosen.first, chosen.last):
        session.param.update(pins=without_pin(session.pins, chosen.first, chosen.last), options=None)
    else:
        session.pins = with_pin(session.pins, options_of(result, session.selected).options[0])
    return True


def ban_unit(session: Session) -> bool:
    """Ban the selected unit, wherever it could be used; a pin on it goes."""
    result = session.result
    if result is None or session.selected >= len(result.selection.chosen):
        return False
    chosen = result.selection.chosen[session.selected]
    if chosen.unit.key in session.bans:
        return False
    pins = without_pin(session.pins, chosen.first, chosen.last)
    session.param.update(pins=pins, bans=(*session.bans, chosen.unit.key), options=None)
    return True


def unban(session: Session, ban: str) -> bool:
    """Allow a banned unit again."""
    if ban not in session.bans:
        return False
    session.bans = tuple(b for b in session.bans if b != ban)
    return True


def heard(session: Session, at: int | None = None) -> Audio | None:
    """Return the sound of the selected fragment (or of option `at`) in its own recording; None without.

    A little is heard on both sides (our choice: 50 ms), so that stops at the edges can be told.
    """
    options = options_shown(session)
    if options is None or session.corpus is None:
        return None
    unit = options.options[options.at if at is None else at].unit
    utterance = session.corpus.utterance(unit.recording)
    if utterance.audio is None:
        return None
    phones = utterance.phones.intervals
    rate = utterance.audio.rate_hz
    first = max(0, round((phones[unit.first].start_s - _AROUND_S) * rate))
    last = round((phones[unit.last].end_s + _AROUND_S) * rate)
    return Audio(utterance.audio.samples[first:last], rate)
