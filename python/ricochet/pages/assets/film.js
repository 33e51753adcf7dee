// SPDX-License-Identifier: BSD-2-Clause
// A film of the animation as WebM: the frames as they are shown, on the colour of the stage, with title, time and colour scale.

const filmTypes = ["video/webm;codecs=vp8", "video/webm"];  // VP9 takes several times as long to encode
const filmType = typeof MediaRecorder === "function" && filmTypes.find(type => MediaRecorder.isTypeSupported(type));

class Film {
  /** Starts a film of a canvas. `done(film)` is called with the finished film, a Blob. */
  constructor(canvas, done) {
    this.source = canvas;
    const {width, height} = canvas, parts = [];
    this.canvas = make("canvas", {width, height});
    this.ink = this.canvas.getContext("2d");
    this.recorder = new MediaRecorder(this.canvas.captureStream(), {mimeType: filmType, videoBitsPerSecond: 8e6});
    this.recorder.addEventListener("dataavailable", ({data}) => parts.push(data));
    this.recorder.addEventListener("stop", () => done(new Blob(parts, {type: "video/webm"})));
    this.recorder.start();
  }

  /** Adds the frame that the source shows, with lines of text and, unless it is null, a scale [low, high, unit]. */
  take(texts, scale) {
    const {ink, canvas: {width, height}} = this, size = Math.round(Math.max(12, width / 50)), css = name => getComputedStyle(section("motion")).getPropertyValue(name);
    ink.fillStyle = css("--stage");
    ink.fillRect(0, 0, width, height);
    ink.drawImage(this.source, 0, 0, width, height);
    ink.fillStyle = css("--ink");
    ink.font = `${size}px ${css("--sans")}`;
    for (const [k, text] of texts.entries()) ink.fillText(text, size, (1.8 + 1.35 * k) * size);
    if (scale) this.scale(scale, size, height - 1.2 * size);
  }

  scale([low, high, unit], size, y) {
    const {ink} = this, long = 9 * size, first = quantity(low, unit), left = 1.5 * size + ink.measureText(first).width;
    ink.fillText(first, size, y);
    for (let x = 0; x < long; ++x) {
      ink.fillStyle = `rgb(${ramp(x / long).map(part => Math.round(255 * part)).join(" ")})`;
      ink.fillRect(left + x, y - 0.7 * size, 1.5, 0.7 * size);
    }
    ink.fillStyle = getComputedStyle(section("motion")).getPropertyValue("--ink");
    ink.fillText(quantity(high, unit, 3), left + long + 0.5 * size, y);
  }

  stop() {
    this.recorder.stop();
  }
}
