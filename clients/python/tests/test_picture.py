"""The merging rules of the picture, message by message."""

import numpy as np
import pytest
from fake_server import make_catalog, make_state

from tumble.picture import Picture


@pytest.fixture
def picture() -> Picture:
    picture = Picture()
    picture.merge_catalog(make_catalog({0: "floor", 1: "ball"}))
    picture.merge_state(make_state({0: 0.0, 1: 1.0}))
    return picture


def height(picture: Picture, name: str) -> float:
    return float(picture.body_state(picture.find(name)).position[2])


def test_complete_when_every_body_is_described_and_placed() -> None:
    picture = Picture()
    picture.merge_state(make_state({0: 0.0, 1: 1.0}))
    assert not picture.is_complete
    picture.merge_catalog(make_catalog({0: "floor", 1: "ball"}))
    assert picture.is_complete


def test_a_body_that_is_not_mentioned_stays(picture: Picture) -> None:
    picture.merge_state(make_state({1: 1.5}, step=3, num_bodies=2))
    assert (height(picture, "floor"), height(picture, "ball")) == (0.0, 1.5)
    assert picture.is_complete and picture.step == 3


def test_an_older_step_that_comes_late_changes_nothing(picture: Picture) -> None:
    picture.merge_state(make_state({1: 5.0}, step=9, num_bodies=2))
    picture.merge_state(make_state({0: 2.0, 1: 4.0}, step=8))
    assert height(picture, "ball") == 5.0
    assert height(picture, "floor") == 2.0  # of this body step 8 is the newest news
    assert picture.step == 9


def test_chunks_of_one_step_come_in_any_order() -> None:
    picture = Picture()
    picture.merge_catalog(make_catalog({0: "a", 1: "b", 2: "c"}))
    for chunk, id in ((2, 2), (0, 0), (1, 1)):
        picture.merge_state(make_state({id: 10.0 + id}, step=4, chunk=chunk, num_chunks=3, num_bodies=3))
    assert [height(picture, name) for name in "abc"] == [10.0, 11.0, 12.0]
    assert picture.is_complete


def test_a_newer_epoch_removes_what_it_does_not_list(picture: Picture) -> None:
    picture.merge_catalog(make_catalog({0: "floor"}, epoch=1, id_limit=2, end_id=2))
    assert picture.find("ball") is None and picture.is_complete
    # A state of before the removal, overtaken on the way, does not bring it back.
    picture.merge_state(make_state({0: 0.0, 1: 1.0}, step=1))
    assert len(picture.snapshot()) == 1 and picture.is_complete


def test_an_epoch_speaks_only_of_its_range(picture: Picture) -> None:
    picture.merge_catalog(make_catalog({}, epoch=1, num_bodies=2, id_limit=5, first_id=2, end_id=5))
    assert picture.find("ball") is not None


def test_a_new_generation_is_a_new_body(picture: Picture) -> None:
    picture.merge_state(make_state({1: 3.0}, step=5, generation=1, catalog_epoch=1, num_bodies=2))
    assert picture.find("ball") is None  # its description is of the one before
    picture.merge_state(make_state({1: 9.0}, step=6, generation=0, catalog_epoch=1, num_bodies=2))
    picture.merge_catalog(make_catalog({1: "cube"}, generation=1, epoch=1, num_bodies=2, first_id=1))
    assert height(picture, "cube") == 3.0


def test_a_new_session_starts_from_nothing_and_stragglers_are_ignored(picture: Picture) -> None:
    assert picture.merge_state(make_state({0: 1.0}, session=2, utime=5000))
    assert picture.session == 2 and picture.find("ball") is None
    assert not picture.merge_state(make_state({0: 7.0, 1: 7.0}, step=900, session=1, utime=4000))
    assert picture.session == 2


def test_snapshot_rows_belong_to_names(picture: Picture) -> None:
    state = picture.snapshot()
    assert state.names == ["floor", "ball"] and state.positions.shape == (2, 3)
    np.testing.assert_array_equal(state["ball"].position, [0, 0, 1])
    picture.merge_state(make_state({1: 8.0}, step=1, num_bodies=2))
    assert state["ball"].position[2] == 1.0  # a copy


def test_a_thousand_bodies_merge_into_the_right_rows() -> None:
    picture = Picture()
    ids = list(range(1999, -1, -2))
    picture.merge_catalog(make_catalog({id: f"body{id}" for id in ids}))
    picture.merge_state(make_state({id: float(id) for id in ids}))
    state = picture.snapshot()
    np.testing.assert_array_equal(state.positions[:, 2], state.ids)
    assert picture.is_complete and state.names[0] == "body1"
