// SPDX-License-Identifier: Apache-2.0
import {Lost, type Connection} from './connection';
import type {Clip, Picture, PictureHeader} from './contract';

// What is to be seen in the picture.
export interface Wanted {
  frame: number;
  revision: number;
  aircraft: boolean;
  scale: number;
}

// Whether what is shown is what is wanted, or newer.
const isMet = (shown: Wanted|null, wanted: Wanted|null) => Boolean(
    shown && wanted && shown.frame === wanted.frame && shown.aircraft === wanted.aircraft &&
    shown.scale === wanted.scale && shown.revision >= wanted.revision);
const isSameWanted = (a: Wanted|null, b: Wanted|null) => JSON.stringify(a) === JSON.stringify(b);
const isPicture = (answer: unknown): answer is Picture =>
    typeof answer === 'object' && answer !== null && 'jpeg' in answer;

// The frame that is shown, on a canvas of the clip's size: asked for whole when things rest, and by what changed of it
// while something is dragged.
export class Pictures {
  readonly canvas = document.createElement('canvas');
  onDrawn: (header: PictureHeader) => void = () => {};
  onRefused: (line: string) => void = () => {};

  private shown: Wanted|null = null;
  private wanted: Wanted|null = null;
  private asked: Wanted|null = null;
  private drawing: Promise<void> = Promise.resolve();

  constructor(private connection: Connection) {
    connection.onPicture = (picture) => {
      const {frame, revision} = picture.header;
      if (this.shown?.aircraft && this.shown.frame === frame && this.shown.revision === revision)
        void this.draw(picture);
    };
  }

  begin(clip: Clip): void {
    if (this.canvas.width === clip.width && this.canvas.height === clip.height) return;
    [this.canvas.width, this.canvas.height] = [clip.width, clip.height];
    this.forget();
  }

  // What was asked for will not come, and what is shown may be old.
  forget(): void {
    this.shown = this.asked = null;
  }


  get isWhole(): boolean {
    return !this.asked && isMet(this.shown, this.wanted);
  }

  // The whole frame: one request at a time, and then the newest wish.
  want(wanted: Wanted): void {
    this.wanted = wanted;
    void this.ask();
  }

  // What changed of the frame shown by an edit that was sent just before: the revision that was drawn, or none.
  async change(frame: number): Promise<number|null> {
    const answer = await this.connection.request('frame', {frame, aircraft: true, crop: 'change', scale: 1});
    if (!isPicture(answer)) return null;
    const {crop, revision} = answer.header;
    const isWhole = crop[2] >= this.canvas.width && crop[3] >= this.canvas.height;
    if (this.shown?.frame !== frame && !isWhole) return null;
    await this.draw(answer);
    this.shown = {frame, revision, aircraft: true, scale: isWhole ? 1 : this.shown?.scale ?? 1};
    return revision;
  }

  private async ask(): Promise<void> {
    if (this.asked || !this.wanted || isMet(this.shown, this.wanted)) return;
    const asked = this.wanted;
    this.asked = asked;
    try {
      const answer = await this.connection.request(
          'frame', {frame: asked.frame, aircraft: asked.aircraft, crop: null, scale: asked.scale});
      if (isPicture(answer)) {
        await this.draw(answer);
        // What is newer than the wish is as good.
        if (this.asked === asked) this.shown = {...asked, revision: Math.max(asked.revision, answer.header.revision)};
      }
      if (this.asked !== asked) return;
      this.asked = null;
      if (!isPicture(answer) && isSameWanted(asked, this.wanted))
        return;  // another request took its place, and asks again when it is done
    } catch (error) {
      if (this.asked === asked) this.asked = null;
      if (error instanceof Lost) return;
      this.onRefused((error as Error).message);
      if (isSameWanted(asked, this.wanted)) return;
    }
    void this.ask();
  }

  // In the order of their coming, whatever decoding takes.
  private draw(picture: Picture): Promise<void> {
    const bitmap = createImageBitmap(picture.jpeg);
    this.drawing = this.drawing.then(async () => this.put(picture.header, await bitmap)).catch(() => undefined);
    return this.drawing;
  }

  private put(header: PictureHeader, bitmap: ImageBitmap): void {
    const [x, y, w, h] = header.crop;
    this.canvas.getContext('2d')!.drawImage(bitmap, x, y, w, h);
    bitmap.close();
    this.onDrawn(header);
  }
}
