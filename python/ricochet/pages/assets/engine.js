// SPDX-License-Identifier: BSD-2-Clause
"use strict";
// The player in WebAssembly (web/player_web.cpp): for the audio thread of a page, for the page itself, and for Node.

class Engine {
  /** @param wasm  bytes of the module  @param block  bytes of the instrument  @param rate  [Hz]. Throws an Error with one line. */
  constructor(wasm, block, rate) {
    const refuse = at => { throw new Error(this.text(at)); };
    const {exports} = new WebAssembly.Instance(new WebAssembly.Module(wasm), {
      env: {refuse, emscripten_notify_memory_growth() {}},
      wasi_snapshot_preview1: {proc_exit() { throw new Error("the player has ended: no memory?"); }},
    });
    this.exports = exports;
    exports._initialize();
    new Uint8Array(exports.memory.buffer).set(block, exports.reserve(block.length));
    exports.load(rate);
    this.contactRate = exports.contact_rate();
  }

  text(at) {
    const bytes = new Uint8Array(this.exports.memory.buffer), end = bytes.indexOf(0, at);
    return Array.from(bytes.subarray(at, end), code => String.fromCharCode(code)).join("");
  }

  strike({place = 0, mallet = 0, speed = 1, after = 0}) { return this.exports.strike(place, mallet, speed, after) !== 0; }
  setDamping(factor) { this.exports.set_damping(factor); }
  /** Renders up to 4096 samples. Returns views [left, right], valid until the next call. */
  process(samples) {
    this.exports.process(samples);
    return [this.exports.left_channel(), this.exports.right_channel()].map(at => new Float32Array(this.exports.memory.buffer, at, samples));
  }
  /** Forces [N] of the contact steps since the last mallet came, valid until the next call. */
  forces() { return new Float64Array(this.exports.memory.buffer, this.exports.forces(), this.exports.force_count()); }
  /** Amplitude of the velocity of each mode in the left channel [m/s], valid until the next call. */
  amplitudes() { return new Float64Array(this.exports.memory.buffer, this.exports.amplitudes(), this.exports.modes()); }
  get mallets() { return this.exports.mallets(); }
}
