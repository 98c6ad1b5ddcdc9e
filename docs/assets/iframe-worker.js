// Search in pages that are opened from the disk, where browsers allow no worker: a hidden frame does its work.
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super()
      this.frame = Object.assign(document.createElement("iframe"), { hidden: true })
      document.body.appendChild(this.frame)
      const inside = this.frame.contentWindow
      inside.postMessage = data => this.dispatchEvent(new MessageEvent("message", { data }))
      inside.importScripts = (...urls) => urls.reduce((before, source) => before.then(() => this.load(source)), Promise.resolve())
      this.ready = this.load(url)
    }

    load(source) {
      const inside = this.frame.contentDocument
      const script = Object.assign(inside.createElement("script"), { src: source })
      return new Promise(done => { script.onload = done; inside.body.appendChild(script) })
    }

    postMessage(data) {
      this.ready.then(() => this.frame.contentWindow.dispatchEvent(new MessageEvent("message", { data: structuredClone(data) })))
    }
  }
}
