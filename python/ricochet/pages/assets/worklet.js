// SPDX-License-Identifier: BSD-2-Clause
// The audio thread of a page. It receives {strike} and {damping}, and reports each blow when its contact has ended.

registerProcessor("ricochet", class extends AudioWorkletProcessor {
  constructor({processorOptions: {wasm, block, strikes = []}}) {  // strikes: known from the start, for offline rendering
    super();
    this.engine = new Engine(wasm, block, sampleRate);
    this.struck = strikes.filter(strike => this.engine.strike(strike)).length > 0;
    this.port.onmessage = ({data}) => {
      if (data.strike) this.struck = this.engine.strike(data.strike) || this.struck;
      if (data.damping !== undefined) this.engine.setDamping(data.damping);
    };
  }

  process(inputs, [[left, right]]) {
    const sound = this.engine.process(left.length);
    left.set(sound[0]);
    (right ?? left).set(sound[1]);
    const touching = this.engine.mallets > 0;
    if (this.struck && !touching && this.engine.forces().length > 0) {
      const {forces, rate} = this.pulse();
      this.port.postMessage({forces, rate, amplitudes: this.engine.amplitudes().slice()});
      this.struck = false;
    }
    return true;
  }

  /** The forces of the last blow, without the zeros after it. */
  pulse() {
    const all = this.engine.forces();
    let end = all.length;
    while (end > 0 && all[end - 1] === 0) --end;
    return {forces: all.slice(0, end + 1), rate: this.engine.contactRate};
  }
});
