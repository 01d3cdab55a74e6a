/** One binary telemetry frame; the layout is in docs/protocol.md, "Telemetry frames". */

const MAGIC = 0x45535356; // "VSSE", little endian
const HEADER_BYTES = 48;
const VERSION = 1;

export class TelemetryFrame {
  /** @param {ArrayBuffer} buffer @throws {Error} if it is no frame of this version, or cut short */
  constructor(buffer) {
    const header = new DataView(buffer);
    if (buffer.byteLength < HEADER_BYTES || header.getUint32(0, true) !== MAGIC)
      throw new Error("not a telemetry frame");
    const version = header.getUint16(4, true);
    if (version !== VERSION)
      throw new Error(`telemetry frame version ${version}; this page reads ${VERSION}. Reload the page.`);
    this.isHistory = (header.getUint16(6, true) & 1) === 1;
    this.channels = header.getUint32(8, true);
    this.samples = header.getUint32(12, true);
    this.epoch = header.getUint32(16, true);
    this.sequence = Number(header.getBigUint64(24, true));
    this.startTime = header.getFloat64(32, true);
    this.sampleTime = header.getFloat64(40, true);
    const expected = HEADER_BYTES + 4 * this.channels * this.samples;
    if (buffer.byteLength !== expected)
      throw new Error(`telemetry frame of ${buffer.byteLength} bytes; expected ${expected}`);
    this.buffer = buffer;
  }

  /** Sequence number of the sample after this frame's last. */
  get nextSequence() {
    return this.sequence + this.samples;
  }

  /** @returns {Float32Array} the samples of one channel, a view without a copy */
  column(row) {
    return new Float32Array(this.buffer, HEADER_BYTES + 4 * row * this.samples, this.samples);
  }
}
