"""The walks of a person that the tests play: a made one everywhere, the recorded one where it is."""
import pytest

from afo import recording
from gait_play import write
from made_gait import made_gait


@pytest.fixture(scope="session", params=["made", pytest.param("recorded", marks=pytest.mark.data)])
def person(request, tmp_path_factory):
    """The file of a walk on level ground."""
    if request.param == "recorded":
        return recording()
    return write(tmp_path_factory.mktemp("person") / "made.csv", made_gait())
