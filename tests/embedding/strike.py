# SPDX-License-Identifier: BSD-2-Clause
"""Checks that the bar of the example sounds at tabulated frequencies: python3 strike.py PROGRAM FOLDER."""

import pathlib
import subprocess
import sys
import wave

import numpy as np

program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
folder.mkdir(parents=True, exist_ok=True)
path = folder / "bar.wav"
path.unlink(missing_ok=True)
said = subprocess.run([program, path], capture_output=True, text=True, check=True).stdout
assert "full scale is" in said, said

with wave.open(str(path)) as file:
    assert (file.getnchannels(), file.getsampwidth(), file.getframerate()) == (2, 3, 44100)
    raw = np.frombuffer(file.readframes(file.getnframes()), np.uint8).reshape(-1, 2, 3).astype(np.int32)
sound = ((raw[..., 0] << 8 | raw[..., 1] << 16 | raw[..., 2] << 24) >> 8) / 2**23
assert sound.shape == (2 * 44100, 2)
assert abs(np.abs(sound).max() - 0.9) < 1e-6

# Free-free bar (Blevins 1979): β L = 4.73004, 7.85320, 10.99561; f = (β L)² h √(E / 12 ρ) / (2π L²)
f = (
    np.array([4.73004074, 7.85320462, 10.9956078]) ** 2
    * 0.006
    * np.sqrt(70e9 / (12 * 2700))
    / (2 * np.pi * 0.3**2)
)
for channel in sound.T:
    ringing = channel[len(channel) // 4 :]
    ringing = ringing * np.hanning(len(ringing))
    spectrum, bin_hz = np.abs(np.fft.rfft(ringing, 2**18)), 44100 / 2**18
    for frequency in f:
        near = slice(int(0.95 * frequency / bin_hz), int(1.05 * frequency / bin_hz))
        peak = (near.start + np.argmax(spectrum[near])) * bin_hz
        assert abs(peak - frequency) < 0.5, (peak, frequency)  # a third of the resolution of the window

before = set(folder.iterdir())
for words, status, part in [
    (["--help"], 0, "usage: strike OUT.wav"),
    ([path, "-h"], 0, "usage: strike OUT.wav"),
    (["--version"], 0, "Ricochet "),
    (["--loud"], 2, "strike: --loud: is not an option"),
    (["--loud.wav", path], 2, "strike: --loud.wav: is not an option"),
    ([], 2, "usage: strike OUT.wav"),
]:
    run = subprocess.run([program, *words], capture_output=True, text=True, cwd=folder)
    said, silent = (run.stderr, run.stdout) if status else (run.stdout, run.stderr)
    assert (run.returncode, silent) == (status, "") and part in said, run
    assert status == 0 or said.count("\n") == 1, run
assert set(folder.iterdir()) == before

refused = subprocess.run([program, path, "nowhere.h5"], capture_output=True, text=True)
assert refused.returncode == 2 and refused.stderr.count("\n") == 1 and "nowhere.h5" in refused.stderr, refused
