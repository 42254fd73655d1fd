"""Client of Tumble, the authoritative rigid-body physics server over LCM.

    from tumble import World

    with World() as world:
        world["ball"].push(force=(0, 0, 50), seconds=0.5)

World frame: right-handed, z up, SI units. Positions are centres of mass, quaternions (w, x, y, z).
"""

from .body import Body
from .contacts import Contacts
from .errors import BusError, NoAnswer, NoServer, Refused, TumbleError, UnknownBody
from .log import Log
from .outbox import Answer, Status
from .picture import BodyState, Description, Shape, State
from .query import Hit
from .world import World

__all__ = [
    "Answer",
    "Body",
    "BodyState",
    "BusError",
    "Contacts",
    "Description",
    "Hit",
    "Log",
    "NoAnswer",
    "NoServer",
    "Refused",
    "Shape",
    "State",
    "Status",
    "TumbleError",
    "UnknownBody",
    "World",
]
