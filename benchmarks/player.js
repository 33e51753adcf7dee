// SPDX-License-Identifier: BSD-2-Clause
// Plays as player.cpp does, in WebAssembly, after as long a time in which Node compiles it well: node player.js ENGINE.js PLAYER.wasm FILE RATE_HZ SECONDS EVERY SAMPLES.
"use strict";
const {readFileSync} = require("fs");
const [script, wasm, block, ...numbers] = process.argv.slice(2), [rate, seconds, every, samples] = numbers.map(Number);
const Engine = new Function(`${readFileSync(script, "utf8")}\nreturn Engine;`)();
const engine = new Engine(readFileSync(wasm), readFileSync(block), rate), places = readFileSync(block).readUInt32LE(24);
const blocks = Math.floor(seconds * rate / samples), pause = Math.floor(every * rate / samples);
const play = () => {
  for (let k = 0; k < blocks; ++k) {
    if (k % pause === 0) engine.strike({place: Math.floor(k / pause) % places});
    engine.process(samples);
  }
};
play();
const start = process.hrtime.bigint();
play();
console.log(Number(process.hrtime.bigint() - start) / 1e9);
