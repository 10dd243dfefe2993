//! The C interface of Open Image Denoise 2, found when it is asked for.

use super::{Images, VARIABLE};
use libloading::{Library, Symbol};
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};

#[cfg(target_os = "windows")]
const NAMES: &[&str] = &["OpenImageDenoise.dll"];
#[cfg(target_os = "macos")]
const NAMES: &[&str] = &["libOpenImageDenoise.2.dylib", "libOpenImageDenoise.dylib"];
#[cfg(not(any(target_os = "windows", target_os = "macos")))]
const NAMES: &[&str] = &["libOpenImageDenoise.so.2", "libOpenImageDenoise.so"];

/// `OIDN_DEVICE_TYPE_CPU`: other devices cannot read the host's memory everywhere.
const DEVICE_CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
const FORMAT_FLOAT3: c_int = 3;

type NewDevice = unsafe extern "C" fn(c_int) -> *mut c_void;
type OfHandle = unsafe extern "C" fn(*mut c_void);
type GetDeviceError = unsafe extern "C" fn(*mut c_void, *mut *const c_char) -> c_int;
type NewFilter = unsafe extern "C" fn(*mut c_void, *const c_char) -> *mut c_void;
type SetSharedFilterImage = unsafe extern "C" fn(
    *mut c_void,
    *const c_char,
    *mut c_void,
    c_int,
    usize,
    usize,
    usize,
    usize,
    usize,
);
type SetFilterBool = unsafe extern "C" fn(*mut c_void, *const c_char, bool);

/// The library, loaded.
pub struct Oidn2 {
    library: Library,
}

impl Oidn2 {
    /// Loads the library: the one that [`VARIABLE`] names, else the system's.
    pub fn load() -> Result<Self, String> {
        let named = std::env::var(VARIABLE).ok().filter(|name| !name.is_empty());
        let names: Vec<&str> = named.as_deref().map_or(NAMES.to_vec(), |name| vec![name]);
        let mut reason = String::new();
        for name in names {
            // SAFETY: the library is what the user has installed under this name, or has named; its
            // initialisers are run as those of any program that uses it.
            match unsafe { Library::new(name) } {
                Ok(library) => return Self::check(library, name),
                Err(error) => reason = error.to_string(),
            }
        }
        Err(reason)
    }

    /// Fails where the library lacks something, as releases before 2.0 do.
    fn check(library: Library, name: &str) -> Result<Self, String> {
        let oidn = Self { library };
        for symbol in [
            "oidnNewDevice",
            "oidnCommitDevice",
            "oidnGetDeviceError",
            "oidnReleaseDevice",
            "oidnNewFilter",
            "oidnSetSharedFilterImage",
            "oidnSetFilterBool",
            "oidnCommitFilter",
            "oidnExecuteFilter",
            "oidnReleaseFilter",
        ] {
            // SAFETY: nothing is called; it is only asked for.
            unsafe { oidn.symbol::<OfHandle>(symbol) }
                .map_err(|_| format!("{name} has no {symbol}; version 2 is needed"))?;
        }
        Ok(oidn)
    }

    /// # Safety
    /// `F` must be the type of the function in version 2 of the library.
    unsafe fn symbol<F>(&self, name: &str) -> Result<Symbol<'_, F>, String> {
        // SAFETY: as the caller promises.
        unsafe { self.library.get(name.as_bytes()) }.map_err(|error| error.to_string())
    }

    /// Calls a function of a handle.
    fn of_handle(&self, name: &str, handle: *mut c_void) -> Result<(), String> {
        // SAFETY: every function that this is called with takes a handle of the library, which is
        // live, and returns nothing.
        unsafe {
            self.symbol::<OfHandle>(name)?(handle);
        }
        Ok(())
    }

    /// The last error of a device, or of making one.
    fn last_error(&self, device: *mut c_void) -> Result<(), String> {
        let mut message: *const c_char = null();
        // SAFETY: the function takes a device or null, and a place for a string of its own.
        let code = unsafe {
            self.symbol::<GetDeviceError>("oidnGetDeviceError")?(device, &raw mut message)
        };
        if code == 0 {
            return Ok(());
        }
        if message.is_null() {
            return Err(format!("error {code}"));
        }
        // SAFETY: the string ends with a zero, and lives until the next error.
        Err(unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned())
    }

    /// A picture without noise, as the library's filter for path tracing sees it.
    pub fn filter(&self, images: &Images<'_>) -> Result<Vec<[f32; 3]>, String> {
        // SAFETY: the function takes a number of the enum and gives a handle or null.
        let device = unsafe { self.symbol::<NewDevice>("oidnNewDevice")?(DEVICE_CPU) };
        if device.is_null() {
            self.last_error(null_mut())?;
            return Err("it has no device for the CPU".into());
        }
        let result = self
            .of_handle("oidnCommitDevice", device)
            .and_then(|()| self.last_error(device))
            .and_then(|()| self.filter_on(device, images));
        self.of_handle("oidnReleaseDevice", device)?;
        result
    }

    fn filter_on(&self, device: *mut c_void, images: &Images<'_>) -> Result<Vec<[f32; 3]>, String> {
        // SAFETY: the function takes a live device and a string that ends with a zero.
        let filter = unsafe { self.symbol::<NewFilter>("oidnNewFilter")?(device, c"RT".as_ptr()) };
        if filter.is_null() {
            self.last_error(device)?;
            return Err("it has no filter for path tracing".into());
        }
        let mut output = vec![[0.0; 3]; images.color.len()];
        let result =
            self.execute(filter, images, &mut output).and_then(|()| self.last_error(device));
        self.of_handle("oidnReleaseFilter", filter)?;
        result.map(|()| output)
    }

    fn execute(
        &self,
        filter: *mut c_void,
        images: &Images<'_>,
        output: &mut [[f32; 3]],
    ) -> Result<(), String> {
        let pixels = images.width as usize * images.height as usize;
        let set = |name: &str, image: *mut c_void, len: usize| -> Result<(), String> {
            assert_eq!(len, pixels, "{name} has as many pixels as the picture");
            let name = CString::new(name).map_err(|error| error.to_string())?;
            // SAFETY: the image has width times height pixels of three floats without gaps, and
            // outlives the filter's execution.
            unsafe {
                self.symbol::<SetSharedFilterImage>("oidnSetSharedFilterImage")?(
                    filter,
                    name.as_ptr(),
                    image,
                    FORMAT_FLOAT3,
                    images.width as usize,
                    images.height as usize,
                    0,
                    0,
                    0,
                );
            }
            Ok(())
        };
        // The library only reads what it is given as an input.
        let input = |image: &[[f32; 3]]| image.as_ptr().cast_mut().cast::<c_void>();
        set("color", input(images.color), images.color.len())?;
        if let Some([albedo, normal]) = images.features {
            set("albedo", input(albedo), albedo.len())?;
            set("normal", input(normal), normal.len())?;
        }
        set("output", output.as_mut_ptr().cast(), output.len())?;
        // SAFETY: the function takes a live filter and a string that ends with a zero.
        unsafe {
            self.symbol::<SetFilterBool>("oidnSetFilterBool")?(filter, c"hdr".as_ptr(), true);
        }
        self.of_handle("oidnCommitFilter", filter)?;
        self.of_handle("oidnExecuteFilter", filter)
    }
}
