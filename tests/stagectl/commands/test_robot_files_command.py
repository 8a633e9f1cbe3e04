"""Files for a robot's controller: what they say is what our ends of the wires read and write.

No controller has run them: that is said in each of them, and here only words, ports, fields and limits are looked at.
"""

import re
import socketserver
from collections.abc import Iterator
from pathlib import Path
from threading import Thread
from xml.etree import ElementTree

import numpy as np
import pytest

from stagectl.__main__ import main
from stagectl.commands.robot_files_command import filled
from stagectl.link.bus import LinkError
from stagectl.robot.config import CellConfig, Robot
from stagectl.robot.program import RobotProgram, TorqueSignals
from stagectl.wire.robot import RATE, Command, Outputs
from stagectl.wire.rsi import MODULUS, REACH, SENDER, SHIFT, TURN, Rsi
from tests.contract.source_tree import ROOT
from tests.stagectl.wire.test_rsi import ANGLES, TELEGRAM

RSI = CellConfig(robot=Robot(wire="rsi", listen="172.31.2.1", port=49_152, late=500))
EGM = CellConfig(robot=Robot(listen="192.168.125.99", commands=7_011, signals=7_012))
KUKA, ABB = dict(filled("kuka", RSI)), dict(filled("abb", EGM))
ETHERNET = ElementTree.fromstring(KUKA["vibrostage_ethernet.xml"])
CONTEXT = ElementTree.fromstring(KUKA["vibrostage.rsi.xml"].encode())
TALK, SIGNALS, MOTION = (ABB[f"vibrostage_{name}.mod"] for name in ("talk", "signals", "motion"))


def channels(way: str) -> dict[str, str]:
    """Return the index of each tag of SEND or RECEIVE."""
    return {each.attrib["TAG"]: each.attrib["INDX"] for each in ETHERNET.findall(f"{way}/ELEMENTS/ELEMENT")}


def parameters(name: str) -> dict[str, str]:
    """Return the parameters of an object of the context."""
    (found,) = CONTEXT.findall(f"RSIObject[@ObjID='{name}']")
    return {each.attrib["Name"]: each.attrib["ParamValue"] for each in found.findall("Parameters/Parameter")}


def links(name: str) -> dict[int, tuple[str, int]]:
    """Return what each input of an object of the context is wired to."""
    (found,) = CONTEXT.findall(f"RSIObject[@ObjID='{name}']")
    return {
        int(each.attrib["InIdx"]): (each.attrib["OutObjID"], int(each.attrib["OutIdx"]))
        for each in found.findall("Inputs/Input")
    }


def telegram() -> bytes:
    """Return the telegram that a controller makes of SEND: an element a name, its dotted parts as attributes."""
    keys = {"RIst": "XYZABC", "RSol": "XYZABC", "Delay": "D"}
    parts: dict[str, list[str]] = {}
    for tag in channels("SEND"):
        name, _, key = tag.removeprefix("DEF_").partition(".")
        joints = [f"A{n}" for n in range(1, 7)]
        parts.setdefault(name, []).extend([key] if key else keys.get(name, joints))
    body = "".join(f"<{name} " + " ".join(f'{key}="0"' for key in keys) + "/>" for name, keys in parts.items())
    return f'<Rob Type="KUKA">{body}<IPOC>4208163634</IPOC></Rob>\n'.encode()


def test_the_telegram_that_the_configuration_makes_is_read() -> None:
    report = Rsi().read(telegram())
    np.testing.assert_allclose(np.degrees(report.joint_angle), [0.0, 90.0, -90.0, 0.0, 0.0, 0.0])
    assert report.stamp < MODULUS


def test_what_is_answered_is_what_the_configuration_takes() -> None:
    wire = Rsi()
    answer = wire.write(Command(1, 0.0, joint_angle=ANGLES, outputs=Outputs()), wire.read(TELEGRAM))
    sen = ElementTree.fromstring(answer)
    sent = {f"{each.tag}.{key}" for each in sen for key in each.attrib}
    assert sent == set(channels("RECEIVE"))
    assert {each.tag for each in sen} - {tag.partition(".")[0] for tag in sent} == {"IPOC"}
    assert sen.attrib["Type"] == ETHERNET.findtext("CONFIG/SENTYPE") == SENDER
    held = {each.attrib.get("HOLDON") for each in ETHERNET.findall("RECEIVE/ELEMENTS/ELEMENT")}
    assert held == {"1"}, "an answer that does not come leaves the last correction"


@pytest.mark.parametrize("address", ["999.1.1.1", "lab-pc", "0.0.0.0", "192.168.125"])
@pytest.mark.parametrize(("maker", "cell"), [("abb", EGM), ("kuka", RSI)])
def test_what_is_no_address_of_one_computer_is_refused(maker: str, cell: CellConfig, address: str) -> None:
    robot = cell.robot.model_copy(update={"listen": address})
    with pytest.raises(ValueError, match=rf"robot.listen is '{address}', must be this computer's IPv4 address"):
        dict(filled(maker, cell.model_copy(update={"robot": robot})))


def test_its_configuration_has_our_address_and_says_nothing_twice() -> None:
    assert ETHERNET.findtext("CONFIG/IP_NUMBER") == "172.31.2.1"
    assert ETHERNET.findtext("CONFIG/PORT") == "49152"
    assert ETHERNET.findtext("CONFIG/ONLYSEND") == "FALSE"
    for way in ("SEND", "RECEIVE"):
        numbers = [int(each) for each in channels(way).values() if each != "INTERNAL"]
        assert sorted(numbers) == list(range(1, len(numbers) + 1))


def test_its_context_wires_each_channel_to_what_the_telegram_says_it_is() -> None:
    receive, send = channels("RECEIVE"), channels("SEND")
    for n in range(1, 7):
        assert links("AXISCORR1")[n] == ("ETHERNET1", int(receive[f"AK.A{n}"]))
        assert links("POSCORR1")[n] == ("ETHERNET1", int(receive[f"RKorr.{'XYZABC'[n - 1]}"]))
        assert links("ETHERNET1")[int(send[f"Corr.A{n}"])] == ("AXISCORRMON1", n)
        assert links("ETHERNET1")[int(send[f"Shift.{'XYZABC'[n - 1]}"])] == ("POSCORRMON1", n)
    for n, name in enumerate(("Clamp", "Block"), start=1):
        assert links(f"MAP2DIGOUT{n}")[1] == ("ETHERNET1", int(receive[f"Set.{name}"]))
        assert links("ETHERNET1")[int(send[f"Out.{name}"])] == (f"DIGOUT{n}", 1)
        assert parameters(f"MAP2DIGOUT{n}") == parameters(f"DIGOUT{n}") == {"Index": str(n), "DataSize": "0"}


def test_its_limits_are_those_by_which_we_refuse() -> None:
    axes, tool = parameters("AXISCORR1"), parameters("POSCORR1")
    for n in range(1, 7):
        assert np.radians(float(axes[f"UpperLimA{n}"])) == pytest.approx(REACH)
        assert float(axes[f"LowerLimA{n}"]) == -float(axes[f"UpperLimA{n}"])
        assert float(parameters("AXISCORRMON1")[f"MaxA{n}"]) > float(axes[f"UpperLimA{n}"])
    for axis in "XYZ":
        assert 1e-3 * float(tool[f"UpperLim{axis}"]) == pytest.approx(SHIFT)
    assert np.radians(float(tool["MaxRotAngle"])) == pytest.approx(TURN)
    assert tool["RefCorrSys"] == "1", "BASE, in which the program puts the null frame"
    assert float(parameters("POSCORRMON1")["MaxTrans"]) > float(tool["UpperLimX"])
    ethernet = parameters("ETHERNET1")
    assert (ethernet["ConfigFile"], ethernet["Timeout"]) == ("vibrostage_ethernet.xml", "500")
    assert int(ethernet["Precision"]) >= 6


def test_its_program_loads_the_context_and_corrects_absolutely_each_4_ms() -> None:
    program = KUKA["vibrostage.src"]
    for line in ('RSI_CREATE("vibrostage.rsi", context, TRUE)', "RSI_ON(#ABSOLUTE, #IPO_FAST)", "RSI_MOVECORR()"):
        assert line in program
    assert "$BASE = $NULLFRAME" in program


def cases(module: str) -> dict[str, list[str]]:
    """Return for each word of the talking module what may be said after it, as its text has it."""
    _, _, body = module.partition("        TEST word\n")
    body = body.partition("\n        ENDTEST")[0]
    found: dict[str, list[str]] = {}
    for part in re.split(r"^        (?=CASE|DEFAULT)", body, flags=re.MULTILINE):
        word = re.match(r'CASE "(\w+)":|DEFAULT:', part)
        if word is not None:
            found[word[1] or ""] = re.findall(r'VsSay "([^"]*)"', part) + re.findall(r"Vs(?:Motion|Await)", part)
    return found


class Played(socketserver.StreamRequestHandler):
    """Plays the module: takes the word of a line, and says what the module's text says after it."""

    def handle(self) -> None:
        said = cases(TALK)
        (good,) = set(re.findall(r'VsSay "(OK)"', TALK))
        for line in self.rfile:
            word, *rest = line.decode("ascii").rstrip("\n").split(" ")
            answers = said.get(word, said[""])
            is_good = word == "RESET" or len(rest) == (6 if word == "SOFT" else 1) and "9" not in rest
            texts = [each for each in answers if each.startswith("ERROR")]
            does = any(each.startswith("Vs") for each in answers)
            self.wfile.write(f"{good if does and is_good else texts[0]}\n".encode())


@pytest.fixture
def played() -> Iterator[RobotProgram]:
    with socketserver.TCPServer(("127.0.0.1", 0), Played) as server:
        thread = Thread(target=server.handle_request)
        thread.start()
        with RobotProgram(Robot(commands=server.server_address[1]), "127.0.0.1") as program:
            yield program
        thread.join()


def test_the_modules_answers_are_those_that_our_end_takes(played: RobotProgram) -> None:
    played.soften([0.85, 0.0, 0.0, 0.0, 0.0, 0.0])
    played.clamp(True)
    played.clamp(False)
    played.change(True)
    played.reset()
    with pytest.raises(LinkError, match="refuses 'SOFT 9 0': ERROR softness must be 6 numbers from 0 to 0.99"):
        played.soften([9, 0])


def test_it_knows_every_word_that_we_say_and_answers_each_line_once() -> None:
    assert set(cases(TALK)) == {"SOFT", "CLAMP", "BLOCK", "SPINDLE", "RESET", ""}
    assert re.search(r'SocketSend vsClient \\Str:=answer \+ "\\0A";', TALK)
    assert TALK.count('StrFind(vsRest, 1, "\\0A")') == 2
    longest = "SOFT " + " ".join(["0.123457"] * 6) + "\n"
    assert len(longest) <= 80, "a RAPID string holds no more"


def test_its_ports_and_limits_are_those_of_the_cells_file() -> None:
    assert "VS_COMMANDS := 7011;" in TALK
    assert "VS_SIGNALS := 7012;" in SIGNALS
    assert "remote address 192.168.125.99, remote port number 6510" in MOTION
    assert "VS_SPEED := 45;" in MOTION  # a tenth of the quickest joint's 450 deg/s
    assert "VS_RAMP_OUT := 0.1;" in MOTION
    for word in ("EGMSetupUC", "EGMActJoint", "EGMRunJoint", "EGMActPose", "EGMRunPose", "EGM_STOP_HOLD"):
        assert word in MOTION


def test_what_both_tasks_share_is_the_same_in_both() -> None:
    def shared(module: str) -> list[str]:
        return [line.strip() for line in module.splitlines() if re.match(r" +PERS num vs|.*VS_(SOFT|RESET) :=", line)]

    assert shared(TALK) == shared(MOTION)
    assert len(shared(TALK)) == 6


def test_a_line_of_its_signals_is_read() -> None:
    """Put together as the module's VsLog puts it: a number, then numbers with a comma before each, then a line feed."""
    _, _, body = SIGNALS.partition("PROC VsLog()")
    puts = re.findall(r"VsPut line, (.*);", body.partition("ERROR")[0])
    line = "".join(put_by(each) * (6 if "TestSignalRead(i)" in each else 1) for each in puts)
    signals = TorqueSignals(Robot(), "127.0.0.1", lambda: 0.0)
    signals.take(line.encode(), 0.0)
    assert (signals.samples.written, signals.garbled) == (1, 0)
    assert "FOR i FROM 1 TO 6 DO" in body


def put_by(source: str) -> str:
    """Return what a `VsPut` of the module puts, with 7 for every number."""
    if source == r'"\0A"':
        return "\n"
    number = re.search(r"NumToStr\(.*, (\d)\)", source)
    assert number is not None
    return ("," if source.startswith('"," + ') else "") + f"{7.0:.{number[1]}f}"


RESERVED = set(
    "alias and backward case connect const default div do else elseif error exit false for from func goto if inout "
    "local mod module not or pers proc raise readonly record retry return step sysmodule test then to trap true "
    "trynext undo var viewonly while with xor".split()
)
"""RAPID's words, which no name may be, however it is spelled."""


def test_the_modules_lines_are_what_a_controller_takes() -> None:
    for name, text in (ABB | KUKA).items():
        assert text.isascii(), name
        assert "@" not in text, name
    for module in (TALK, SIGNALS, MOTION):
        assert max(map(len, module.splitlines())) <= 120
        names = re.findall(r"(?:VAR|PERS|CONST|PROC|FUNC) (?:\w+ )?(\w+)", module)
        assert len(names) > 5
        assert not RESERVED & {name.lower() for name in names}
        for word in ("PROC", "IF", "WHILE", "FOR", "TEST", "FUNC"):
            end = f"END{word}"
            opened = re.findall(rf"^ *{word}\b(?!.* RETURN FALSE;$)", module, re.MULTILINE)
            assert len(opened) == len(re.findall(rf"^ *{end}\b", module, re.MULTILINE)), (module[:30], word)


@pytest.mark.parametrize("text", [*KUKA.values(), *(each for name, each in ABB.items() if name.endswith(".mod"))])
def test_each_says_what_it_was_tried_on(text: str) -> None:
    words = " ".join(text.split())
    assert "Written from the maker's manuals, tried on a simulator only, not on a controller." in words


def test_its_page_names_every_file_object_and_limit() -> None:
    page = (ROOT / "docs/robot-files.md").read_text()
    for name in (*ABB, *KUKA):
        assert f"`{name}`" in page
    for each in CONTEXT:
        assert f"`{each.attrib['ObjID']}`" in page
    reach, shift, turn = np.degrees(REACH), 1e3 * SHIFT, np.degrees(TURN)
    for text in (
        f"limits of {reach:g} deg",
        f"limits of {shift:g} mm, `MaxRotAngle` {turn:g} deg",
        f"{parameters('AXISCORRMON1')['MaxA1']} deg; {parameters('POSCORRMON1')['MaxTrans']} mm, "
        f"{parameters('POSCORRMON1')['MaxRotAngle']} deg",
    ):
        assert text in page
    assert CellConfig().robot.late / RATE == 600.0, "ten minutes, as the page says"


def test_the_command_writes_them_and_refuses_what_does_not_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def run(*words: str) -> int:
        monkeypatch.setattr("sys.argv", ["stagectl", "robot-files", *words, "--out", str(tmp_path / "made")])
        return main()

    assert run("kuka", "--set", "robot.wire=rsi") == 0
    assert {file.name for file in (tmp_path / "made").iterdir()} == set(KUKA)
    *written, where, note = capsys.readouterr().out.splitlines()
    assert len(written) == len(KUKA)
    assert where == "docs/robot-files.md says where each belongs"
    assert note.startswith("robot.listen is 127.0.0.1, where only a simulator finds this computer")
    assert run("kuka", "--set", "robot.wire=rsi", "--set", "robot.listen=172.31.2.1") == 0
    assert "only a simulator" not in capsys.readouterr().out
    for words, reason in (
        (("fanuc",), "the maker is 'fanuc', must be one of abb, kuka"),
        (("kuka",), "robot.wire is 'egm', must be 'rsi' for a robot of kuka"),
        (("abb", "--set", "robot.signals=0"), "robot.signals 0, must be > 0"),
        (("kuka", "--set", "robot.wire=rsi", "--set", "robot.port=0"), "robot.port is 0, must be > 0"),
    ):
        assert run(*words) == 2
        assert reason in capsys.readouterr().err
