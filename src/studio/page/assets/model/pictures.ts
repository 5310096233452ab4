// SPDX-License-Identifier: Apache-2.0
import { Lost, type Connection } from './connection';
import type { Clip, Picture } from './contract';
import { type Crop, joined } from './geometry';

// What is to be seen in the picture.
export interface Wanted {
  frame: number;
  revision: number;
  aircraft: boolean;
  scale: number;
}

const isSameWanted = (a: Wanted | null, b: Wanted | null) => JSON.stringify(a) === JSON.stringify(b);
const isPicture = (answer: unknown): answer is Picture => typeof answer === 'object' && answer !== null && 'jpeg' in answer;

// The frame that is shown, on a canvas of the clip's size: asked for whole when things rest, and in parts while something is dragged.
export class Pictures {
  readonly canvas = document.createElement('canvas');
  onDrawn: () => void = () => {};
  onRefused: (line: string) => void = () => {};

  private shown: Wanted | null = null;
  private wanted: Wanted | null = null;
  private asked: Wanted | null = null;
  private dirty: Crop | null = null; // painted by parts since the last whole frame
  private parts = 0;

  constructor(private connection: Connection) {}

  begin(clip: Clip): void {
    if (this.canvas.width === clip.width && this.canvas.height === clip.height) return;
    [this.canvas.width, this.canvas.height] = [clip.width, clip.height];
    this.forget();
  }

  // What was asked for will not come, and what is shown may be old.
  forget(): void {
    this.shown = this.asked = null;
  }

  get frame(): number | null {
    return this.shown?.frame ?? null;
  }

  get isWhole(): boolean {
    return !this.asked && !this.dirty && isSameWanted(this.shown, this.wanted);
  }

  // The whole frame: one request at a time, and then the newest wish.
  want(wanted: Wanted): void {
    this.wanted = wanted;
    void this.ask();
  }

  // A part of the frame shown, after an edit that was sent just before. Whether it was drawn, and of which revision.
  async part(frame: number, crop: Crop): Promise<number | null> {
    const region = joined(this.dirty, crop)!;
    this.dirty = region;
    this.parts += 1;
    try {
      const answer = await this.connection.request('frame', { frame, aircraft: true, crop: region, scale: 1 });
      if (!isPicture(answer) || this.shown?.frame !== frame) return null;
      await this.draw(answer);
      this.dirty = crop;
      return answer.header.revision;
    } finally {
      this.parts -= 1;
    }
  }

  private async ask(): Promise<void> {
    if (this.asked || !this.wanted || (isSameWanted(this.wanted, this.shown) && !this.dirty)) return;
    const asked = this.wanted;
    this.asked = asked;
    try {
      const parts = this.parts;
      const answer = await this.connection.request('frame', { frame: asked.frame, aircraft: asked.aircraft, crop: null, scale: asked.scale });
      if (this.asked !== asked) return;
      this.asked = null;
      if (isPicture(answer)) {
        await this.draw(answer);
        this.shown = { ...asked, revision: answer.header.revision };
        if (!parts && !this.parts) this.dirty = null;
      } else if (isSameWanted(asked, this.wanted)) {
        return; // another request took its place, and asks again when it is done
      }
    } catch (error) {
      if (this.asked === asked) this.asked = null;
      if (error instanceof Lost) return;
      this.onRefused((error as Error).message);
      if (isSameWanted(asked, this.wanted)) return;
    }
    void this.ask();
  }

  private async draw({ header, jpeg }: Picture): Promise<void> {
    const bitmap = await createImageBitmap(jpeg);
    const [x, y, w, h] = header.crop ?? [0, 0, this.canvas.width, this.canvas.height];
    this.canvas.getContext('2d')!.drawImage(bitmap, x, y, w, h);
    bitmap.close();
    this.onDrawn();
  }
}
